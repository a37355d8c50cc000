#pragma once
// Friction constraint of one contact of `soft_step`. It is solved after each relaxed normal impulse,
// limited by mu times that impulse. In an impact it is solved after each impulse of the impact, limited by
// mu times the sum of these impulses.

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/solver/contact_storage.h"
#include "sim_cuda/solver/friction.h"
#include "sim_cuda/solver/soft_contact.h"
#include "sim_cuda/solver/tangent_response.h"

namespace collidoscope {

/// Friction part of a SoftContact.
template <class Real>
struct FrictionImpulse {
  Vector3<Real>
      impulse;  ///< accumulated in the substep, N s, perpendicular to the normal; applied to b, negative to a
  Vector3<Real> impact;  ///< friction impulse of impacts in this substep, N s
  Real coefficient;      ///< friction coefficient of the pair
};

/// Two bodies at a contact. Both arms end at the middle of the overlap, so friction conserves angular
/// momentum.
template <class Real>
struct FrictionConstraint {
  Vector3<Real> angular_velocity_a, angular_velocity_b;  ///< rad/s
  Vector3<Real> normal;
  Real arm_a, arm_b;                          ///< m
  Real inverse_inertia_a, inverse_inertia_b;  ///< see ContactInertia

  SIM_HD FrictionConstraint(const Vector3<Real>& initial_a, const Vector3<Real>& initial_b,
                            const SoftContact<Real>& contact, const ContactBodies<Real>& pair,
                            const ContactInertia<Real>& inertia)
      : angular_velocity_a(initial_a),
        angular_velocity_b(initial_b),
        normal(contact.normal),
        arm_a(pair.radius_a + contact.gap / 2),
        arm_b(pair.radius_b + contact.gap / 2),
        inverse_inertia_a(inertia.inverse_inertia_a),
        inverse_inertia_b(inertia.inverse_inertia_b) {}

  /// Slip velocity of b's surface relative to a's, m/s. `velocity`: of b's centre relative to a's, m/s.
  SIM_HD Vector3<Real> slip(const Vector3<Real>& velocity) const {
    return tangential_part<Real>(
        velocity - (arm_a * angular_velocity_a + arm_b * angular_velocity_b).cross(normal), normal);
  }
  /// Rotational part of the inverse effective mass against slip, 1/kg.
  SIM_HD Real angular_inverse_mass_a() const {
    return arm_a * arm_a * (inverse_inertia_a < 0 ? -inverse_inertia_a : inverse_inertia_a);
  }
  SIM_HD Real angular_inverse_mass_b() const {
    return arm_b * arm_b * (inverse_inertia_b < 0 ? -inverse_inertia_b : inverse_inertia_b);
  }
  SIM_HD bool is_isotropic() const { return !(inverse_inertia_a < 0) && !(inverse_inertia_b < 0); }
  /// `n_a`, `n_b`: number of parts into which the bodies are split.
  SIM_HD TangentResponse<Real> response(const BodyView<Real>& bodies, Pair ids, Real inverse_mass,
                                        Real n_a = 1, Real n_b = 1) const {
    TangentResponse<Real> response(normal, inverse_mass);
    response.add(AngularState<Real>::of(bodies, ids.a), arm_a * arm_a * n_a);
    response.add(AngularState<Real>::of(bodies, ids.b), arm_b * arm_b * n_b);
    return response;
  }
  /// Updates the angular velocities for an impulse at the contact, N s.
  SIM_HD void apply_impulse(const BodyView<Real>& bodies, Pair ids, const Vector3<Real>& impulse) {
    const Vector3<Real> moment = normal.cross(impulse);
    angular_velocity_a =
        angular_velocity_after(bodies, ids.a, angular_velocity_a, inverse_inertia_a, -arm_a * moment);
    angular_velocity_b =
        angular_velocity_after(bodies, ids.b, angular_velocity_b, inverse_inertia_b, -arm_b * moment);
  }

 private:
  SIM_HD static Vector3<Real> angular_velocity_after(const BodyView<Real>& bodies, std::uint32_t body,
                                                     const Vector3<Real>& angular_velocity,
                                                     Real inverse_inertia, const Vector3<Real>& moment) {
    if (inverse_inertia >= 0) return angular_velocity + inverse_inertia * moment;
    AngularState<Real> angular = AngularState<Real>::of(bodies, body);
    angular.velocity = angular_velocity;
    angular.apply_angular_impulse(moment);
    return angular.velocity;
  }
};

}  // namespace collidoscope

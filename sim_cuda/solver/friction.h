#pragma once
// Coulomb friction: the tangential impulse of a contact is at most mu times its normal impulse. Required if
// a material has a nonzero coefficient; needs rotation. The coefficients of a pair are combined as
// sqrt(mu_a mu_b), as in Box2D and box3d.
//
// The impulse is clamped as a vector. Separate clamping of two axes would let bodies creep across the
// diagonal.

#include <cstdint>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/dynamics/body_state.h"

namespace collidoscope {

template <class Real>
struct Friction {
  const Real* of_material = nullptr;        ///< coefficient by material, 0 to 100
  const std::uint16_t* material = nullptr;  ///< by body; null: all bodies have material 0

  SIM_HD Real of_body(std::uint32_t body) const {
    return of_material[material == nullptr ? 0 : material[body]];
  }
  SIM_HD static Real between(Real mu_a, Real mu_b) {
    using std::sqrt;
    return sqrt(mu_a * mu_b);
  }
};

/// Returns `impulse` clamped to length `limit` >= 0.
template <class Real>
SIM_HD Vector3<Real> clamp_length(const Vector3<Real>& impulse, Real limit) {
  const Real squared = impulse.dot(impulse);
  if (!(squared > limit * limit)) return impulse;
  using std::sqrt;
  return (limit / sqrt(squared)) * impulse;
}

/// Friction impulse against a slip velocity (m/s) with effective mass `mass` (kg). Updates `accumulated` (N
/// s), whose length is at most `limit` afterwards. Returns the change.
template <class Real>
SIM_HD Vector3<Real> solve_friction(const Vector3<Real>& slip, Real mass, Real limit,
                                    Vector3<Real>& accumulated) {
  const Vector3<Real> next = clamp_length<Real>(accumulated - mass * slip, limit);
  const Vector3<Real> change = next - accumulated;
  accumulated = next;
  return change;
}

/// Component of a vector perpendicular to a unit normal.
template <class Real>
SIM_HD Vector3<Real> tangential_part(const Vector3<Real>& vector, const Vector3<Real>& normal) {
  return vector - vector.dot(normal) * normal;
}

/// Rotational state of a body, and its response to angular impulses.
template <class Real>
struct AngularState {
  Vector3<Real> velocity;  ///< rad/s
  Vector3<Real> inertia;   ///< principal moments, kg m^2
  Quaternion<Real> axes;   ///< principal axes to world; unused for isotropic inertia

  SIM_HD static AngularState of(const BodyView<Real>& bodies, std::uint32_t body) {
    return {bodies.angular_velocity[body], bodies.inertia[body], bodies.orientation[body]};
  }
  SIM_HD bool is_isotropic() const { return inertia.x() == inertia.y() && inertia.y() == inertia.z(); }
  /// Largest inverse principal moment, 1/(kg m^2). An upper bound makes the effective mass a lower bound,
  /// which keeps the solver stable.
  SIM_HD Real inverse_inertia_max() const {
    const Real least = inertia.x() < inertia.y() ? inertia.x() : inertia.y();
    return 1 / (least < inertia.z() ? least : inertia.z());
  }
  /// What a torque-free rotation conserves: the angular velocity of an isotropic body, rad/s; otherwise the
  /// angular momentum, kg m^2/s. In world axes.
  SIM_HD Vector3<Real> spin() const {
    if (is_isotropic()) return velocity;
    const Vector3<Real> body = axes.conjugate() * velocity;
    return axes * Vector3<Real>(body.x() * inertia.x(), body.y() * inertia.y(), body.z() * inertia.z());
  }
  /// kg m^2/s, in world axes.
  SIM_HD Vector3<Real> momentum() const {
    return is_isotropic() ? Vector3<Real>(inertia.x() * velocity) : spin();
  }
  /// Kinetic energy of the rotation of a body with this spin(), J.
  SIM_HD double energy_of(const Vector3<Real>& spin) const {
    const Vector3d own = widened<Real>(axes).conjugate() * widened<Real>(spin);
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += own[k] * own[k] / static_cast<double>(inertia[k]);
    return sum / 2;
  }
  /// The angular velocity of a body with this spin(), rad/s.
  SIM_HD Vector3<Real> velocity_of(const Vector3<Real>& spin) const {
    if (is_isotropic()) return spin;
    const Vector3<Real> body = axes.conjugate() * spin;
    return axes * Vector3<Real>(body.x() / inertia.x(), body.y() / inertia.y(), body.z() / inertia.z());
  }
  /// Change of the angular velocity by a unit of angular impulse along `direction`, along the same direction,
  /// 1/(kg m^2). `direction`: of any length, in world axes.
  SIM_HD Real inverse_inertia_along(const Vector3<Real>& direction) const {
    const Real squared = direction.dot(direction);
    if (is_isotropic() || !(squared > 0)) return inverse_inertia_max();
    const Vector3<Real> own = axes.conjugate() * direction;
    const Real along = (own.x() * own.x() / inertia.x() + own.y() * own.y() / inertia.y() +
                        own.z() * own.z() / inertia.z()) /
                       squared;
    const Real largest = max_of(inertia.x(), max_of(inertia.y(), inertia.z()));
    return max_of(along, 1 / largest);  // the squares of a slow rotation may be 0
  }
  /// `impulse` in N m s, in world axes.
  SIM_HD void apply_angular_impulse(const Vector3<Real>& impulse) {
    if (is_isotropic()) {
      velocity += impulse / inertia.x();
      return;
    }
    const Vector3<Real> body = axes.conjugate() * impulse;
    velocity += axes * Vector3<Real>(body.x() / inertia.x(), body.y() / inertia.y(), body.z() / inertia.z());
  }
};

/// Friction impulses at planes, index plane * body count + body. Null without friction.
template <class Real>
struct WallFriction {
  Friction<Real> coefficients;
  Vector3<Real>* impulse;  ///< accumulated in the substep, N s
};

}  // namespace collidoscope

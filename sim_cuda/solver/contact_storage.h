#pragma once
// How the contacts of `soft_step` lie in memory, by place: what the same stages read lies together, in words
// of 16 bytes in float. What two stages in turn ask for at random, body by body, is one sector of 32 bytes,
// the least that a GPU fetches.

#include <cstdint>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/core/vector_load.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/narrow_phase/sphere_sphere.h"
#include "sim_cuda/solver/friction.h"
#include "sim_cuda/solver/soft_contact.h"

namespace collidoscope {

/// All that a substep needs to start from the one before it.
template <class Real>
struct alignas(4 * sizeof(Real)) PackedContact {
  Vector3<Real> normal;  ///< as SoftContact's
  Real gap;
  Real impulse;
  Vector3<Real>
      friction_impulse;  ///< FrictionImpulse's impulse; without friction it is neither written nor read

  SIM_HD static void store_geometry(PackedContact* target, const Separation<Real>& now) {
    store_vec4(static_cast<void*>(target), now.normal.x(), now.normal.y(), now.normal.z(), now.gap);
  }
  SIM_HD static void store_impulses(PackedContact* target, Real impulse,
                                    const Vector3<Real>& friction_impulse) {
    store_vec4(static_cast<void*>(&target->impulse), impulse, friction_impulse.x(), friction_impulse.y(),
               friction_impulse.z());
  }
};
static_assert(sizeof(PackedContact<float>) == 32 && sizeof(PackedContact<double>) == 64);

/// What the ends of substeps add up.
template <class Real>
struct alignas(2 * sizeof(Real)) ContactSums {
  Real total, approach;  ///< as SoftContact's
};

template <class Real>
struct alignas(4 * sizeof(Real)) FrictionSums {
  Vector3<Real> total;  ///< as FrictionImpulse's
  Real coefficient;
};

/// The bodies of a contact, as the step does not change them: beside it, so that no iteration looks them up.
template <class Real>
struct alignas(4 * sizeof(Real)) ContactBodies {
  Real inverse_mass_a, inverse_mass_b;  ///< 1/kg
  Real radius_a, radius_b;              ///< m

  SIM_HD Separation<Real> at(const Vector3<Real>& a, const Vector3<Real>& b) const {
    return separate<Real>(a, radius_a, b, radius_b);
  }
};

/// The same, as friction asks for it.
template <class Real>
struct alignas(2 * sizeof(Real)) ContactInertia {
  Real inverse_inertia_a, inverse_inertia_b;  ///< as BodyFriction's
};

/// A body as a step finds it: what all its contacts ask for as they are prepared.
template <class Real>
struct alignas(4 * sizeof(Real)) StepBody {
  Vector3<Real> position;  ///< m
  Real radius;             ///< m
  Vector3<Real> velocity;  ///< m/s
  Real inverse_mass;       ///< 1/kg
};
static_assert(sizeof(StepBody<float>) == 32 && sizeof(StepBody<double>) == 64);

/// The same, as friction asks for it.
template <class Real>
struct alignas(2 * sizeof(Real)) BodyFriction {
  Real inverse_inertia;  ///< 1/(kg m^2), as AngularState::inverse_inertia_max(); < 0: minus that of a body
                         ///< that is no ball
  Real coefficient;      ///< of friction

  SIM_HD static BodyFriction of(const BodyView<Real>& bodies, const Friction<Real>& friction,
                                std::uint32_t body) {
    const AngularState<Real> angular = AngularState<Real>::of(bodies, body);
    return {angular.is_isotropic() ? angular.inverse_inertia_max() : -angular.inverse_inertia_max(),
            friction.of_body(body)};
  }
};

}  // namespace collidoscope

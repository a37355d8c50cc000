#pragma once
// How the contacts of `soft_step` lie in memory, by place: what the same stages read lies together, in words
// of 16 bytes in float. What two stages in turn ask for at random, body by body, is one sector of 32 bytes,
// the least that a GPU fetches.

#include <cstdint>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/core/whole_record.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/narrow_phase/sphere_sphere.h"
#include "sim_cuda/solver/friction.h"
#include "sim_cuda/solver/soft_contact.h"

namespace collidoscope {

/// All that a substep needs to start from the one before it.
template <class Real>
struct alignas(4 * sizeof(Real)) StoredContact {
  Vector3<Real> normal;  ///< as SoftContact's
  Real gap;
  Real impulse;
  Vector3<Real> rubbed;  ///< SoftGrip's impulse; without friction it is neither written nor read

  SIM_HD static void store_face(StoredContact* target, const Separation<Real>& now) {
    store_four(static_cast<void*>(target), now.normal.x(), now.normal.y(), now.normal.z(), now.gap);
  }
  SIM_HD static void store_impulses(StoredContact* target, Real impulse, const Vector3<Real>& rubbed) {
    store_four(static_cast<void*>(&target->impulse), impulse, rubbed.x(), rubbed.y(), rubbed.z());
  }
};
static_assert(sizeof(StoredContact<float>) == 32 && sizeof(StoredContact<double>) == 64);

/// What the ends of substeps add up.
template <class Real>
struct alignas(2 * sizeof(Real)) ContactSums {
  Real total, approach;  ///< as SoftContact's
};

template <class Real>
struct alignas(4 * sizeof(Real)) GripSums {
  Vector3<Real> total;  ///< as SoftGrip's
  Real coefficient;
};

/// The bodies of a contact, as the step does not change them: beside it, so that no sweep looks them up.
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
struct alignas(2 * sizeof(Real)) TurnedBodies {
  Real ease_a, ease_b;  ///< as GrippedBody's
};

/// A body as a step finds it: what all its contacts ask for as they are prepared.
template <class Real>
struct alignas(4 * sizeof(Real)) FoundBody {
  Vector3<Real> position;  ///< m
  Real radius;             ///< m
  Vector3<Real> velocity;  ///< m/s
  Real inverse_mass;       ///< 1/kg
};
static_assert(sizeof(FoundBody<float>) == 32 && sizeof(FoundBody<double>) == 64);

/// The same, as friction asks for it.
template <class Real>
struct alignas(2 * sizeof(Real)) GrippedBody {
  Real ease;         ///< 1/(kg m^2), as Spin::ease(); < 0: minus that of a body that is no ball
  Real coefficient;  ///< of friction

  SIM_HD static GrippedBody of(const BodyView<Real>& bodies, const Friction<Real>& friction,
                               std::uint32_t body) {
    const Spin<Real> spin = Spin<Real>::of(bodies, body);
    return {spin.ball() ? spin.ease() : -spin.ease(), friction.of_body(body)};
  }
};

}  // namespace collidoscope

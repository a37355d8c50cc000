#pragma once
// Memory layout of the contacts of `soft_step`, indexed by place in solve order. Data that a stage reads
// together are stored together, in 16-byte words for float. Data that two stages fetch at random per body
// fit one 32-byte sector, the smallest GPU memory transaction. Plain data.

#include <cstdint>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/core/vector_load.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/narrow_phase/sphere_sphere.h"
#include "sim_cuda/solver/friction.h"
#include "sim_cuda/solver/soft_contact.h"

namespace collidoscope {

/// Contact data that a substep takes over from the previous substep.
template <class Real>
struct alignas(4 * sizeof(Real)) PackedContact {
  Vector3<Real> normal;  ///< see SoftContact
  Real gap;
  Real impulse;
  Vector3<Real> friction_impulse;  ///< N s, see FrictionImpulse; unused without friction

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

/// Sums of impulses, for reports and for friction of impacts.
template <class Real>
struct alignas(2 * sizeof(Real)) ContactSums {
  Real total;  ///< see SoftContact
  ImpactSum<Real> impact;
};

template <class Real>
struct alignas(4 * sizeof(Real)) FrictionSums {
  Vector3<Real> impact;  ///< see FrictionImpulse
  Real coefficient;
};

/// Body data of a contact that are constant in a step. A copy per contact saves the lookup by body in each
/// iteration.
template <class Real>
struct alignas(4 * sizeof(Real)) ContactBodies {
  Real inverse_mass_a, inverse_mass_b;  ///< 1/kg
  Real radius_a, radius_b;              ///< m

  SIM_HD Separation<Real> at(const Vector3<Real>& a, const Vector3<Real>& b) const {
    return separate<Real>(a, radius_a, b, radius_b);
  }
};

/// Additional body data of a contact for friction.
template <class Real>
struct alignas(2 * sizeof(Real)) ContactInertia {
  Real inverse_inertia_a, inverse_inertia_b;  ///< see BodyFriction
};

/// Body data at the start of a step, read when contacts are prepared.
template <class Real>
struct alignas(4 * sizeof(Real)) StepBody {
  Vector3<Real> position;  ///< m
  Real radius;             ///< m
  Vector3<Real> velocity;  ///< m/s
  Real inverse_mass;       ///< 1/kg
};
static_assert(sizeof(StepBody<float>) == 32 && sizeof(StepBody<double>) == 64);

/// Additional body data for friction.
template <class Real>
struct alignas(2 * sizeof(Real)) BodyFriction {
  Real inverse_inertia;  ///< 1/(kg m^2), inverse_inertia_max(); negative if the inertia is not isotropic
  Real coefficient;      ///< friction coefficient

  SIM_HD static BodyFriction of(const BodyView<Real>& bodies, const Friction<Real>& friction,
                                std::uint32_t body) {
    const AngularState<Real> angular = AngularState<Real>::of(bodies, body);
    return {angular.is_isotropic() ? angular.inverse_inertia_max() : -angular.inverse_inertia_max(),
            friction.of_body(body)};
  }
};

/// Position of a contact in the solve order of its bodies. `a`, `b`: number of contacts solved before it at
/// that body. `next_a`, `next_b`: counter value after it; 0 after the last.
struct DependencyCounters {
  std::uint8_t a, b, next_a, next_b;

  /// `used`: bit mask of the colours at a body.
  SIM_HD static std::uint8_t before(std::uint32_t used, int colour) {
    return static_cast<std::uint8_t>(count_bits(used & ((std::uint32_t{1} << colour) - 1)));
  }
  SIM_HD static std::uint8_t after(std::uint32_t used, int colour) {
    return used >> colour == 1 ? std::uint8_t{0} : static_cast<std::uint8_t>(before(used, colour) + 1);
  }
  SIM_HD static DependencyCounters of(std::uint32_t used_a, std::uint32_t used_b, int colour) {
    return {before(used_a, colour), before(used_b, colour), after(used_a, colour), after(used_b, colour)};
  }
};

}  // namespace collidoscope

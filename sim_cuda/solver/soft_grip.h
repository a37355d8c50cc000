#pragma once
// What friction gives at one contact of `soft_step`: solved after the normal impulse whenever that is
// relaxed, within mu times it, and once more after the bounces, within mu times the normal impulse of the
// whole step, for a bounce presses harder than the substep in which it began.

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/solver/friction.h"
#include "sim_cuda/solver/soft_contact.h"

namespace collidoscope {

/// Beside each SoftContact; 32 bytes in float, too.
template <class Real>
struct alignas(4 * sizeof(Real)) SoftGrip {
  Vector3<Real> impulse;  ///< N s, across the normal, given to b and taken from a; of the substep
  Real coefficient;       ///< of the pair
  Vector3<Real> total;    ///< N s, of the step so far
};
static_assert(sizeof(SoftGrip<float>) == 32 && sizeof(SoftGrip<double>) == 64);

/// Two bodies at a contact. The arms end in the middle of the overlap, so that what friction gives to both
/// leaves their angular momentum as it is.
template <class Real>
struct RubbedPair {
  Spin<Real> a, b;
  Vector3<Real> normal;
  Real arm_a, arm_b;  ///< m

  SIM_HD RubbedPair(const BodyView<Real>& bodies, Pair ids, const SoftContact<Real>& contact)
      : a(Spin<Real>::of(bodies, ids.a)),
        b(Spin<Real>::of(bodies, ids.b)),
        normal(contact.normal),
        arm_a(bodies.radius[ids.a] + contact.gap / 2),
        arm_b(bodies.radius[ids.b] + contact.gap / 2) {}

  /// m/s, of b's surface on a's; `velocity` of b's centre relative to a's.
  SIM_HD Vector3<Real> slip(const Vector3<Real>& velocity) const {
    return across<Real>(velocity - (arm_a * a.rate + arm_b * b.rate).cross(normal), normal);
  }
  /// 1/kg, that a slip has to move beside the inverse masses of a and b.
  SIM_HD Real ease_a() const { return arm_a * arm_a * a.ease(); }
  SIM_HD Real ease_b() const { return arm_b * arm_b * b.ease(); }
  SIM_HD void turn(const Vector3<Real>& impulse) {
    const Vector3<Real> moment = normal.cross(impulse);
    a.turn(-arm_a * moment);
    b.turn(-arm_b * moment);
  }
};

}  // namespace collidoscope

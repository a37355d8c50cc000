#pragma once
// What friction gives at one contact of `soft_step`: solved after the normal impulse whenever that is
// relaxed, within mu times it, and, where it bounced, once more after all bounces, within mu times the normal
// impulse of the whole step, for a bounce presses harder than the substep in which it began.

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
  Real padding = 0;
};
static_assert(sizeof(SoftGrip<float>) == 32 && sizeof(SoftGrip<double>) == 64);

/// What friction must know of the two bodies of a contact, which the step does not change; 16 bytes in float.
template <class Real>
struct alignas(4 * sizeof(Real)) GrippedPair {
  Real radius_a, radius_b;  ///< m
  Real ease_a, ease_b;      ///< 1/(kg m^2), as Spin::ease(); < 0: minus that of a body that is no ball

  SIM_HD static Real ease(const BodyView<Real>& bodies, std::uint32_t body) {
    const Spin<Real> spin = Spin<Real>::of(bodies, body);
    return spin.ball() ? spin.ease() : -spin.ease();
  }
  SIM_HD static GrippedPair of(const BodyView<Real>& bodies, Pair ids) {
    return {bodies.radius[ids.a], bodies.radius[ids.b], ease(bodies, ids.a), ease(bodies, ids.b)};
  }
};

/// Two bodies at a contact. The arms end in the middle of the overlap, so that what friction gives to both
/// leaves their angular momentum as it is.
template <class Real>
struct RubbedPair {
  Vector3<Real> rate_a, rate_b;  ///< rad/s
  Vector3<Real> normal;
  Real arm_a, arm_b;    ///< m
  Real ball_a, ball_b;  ///< as GrippedPair's eases

  SIM_HD RubbedPair(const Vector3<Real>& spin_a, const Vector3<Real>& spin_b,
                    const SoftContact<Real>& contact, const GrippedPair<Real>& pair)
      : rate_a(spin_a),
        rate_b(spin_b),
        normal(contact.normal),
        arm_a(pair.radius_a + contact.gap / 2),
        arm_b(pair.radius_b + contact.gap / 2),
        ball_a(pair.ease_a),
        ball_b(pair.ease_b) {}

  /// m/s, of b's surface on a's; `velocity` of b's centre relative to a's.
  SIM_HD Vector3<Real> slip(const Vector3<Real>& velocity) const {
    return across<Real>(velocity - (arm_a * rate_a + arm_b * rate_b).cross(normal), normal);
  }
  /// 1/kg, that a slip has to move beside the inverse masses of a and b.
  SIM_HD Real ease_a() const { return arm_a * arm_a * (ball_a < 0 ? -ball_a : ball_a); }
  SIM_HD Real ease_b() const { return arm_b * arm_b * (ball_b < 0 ? -ball_b : ball_b); }
  /// What an impulse at the contact, N s, makes of the spins.
  SIM_HD void turn(const BodyView<Real>& bodies, Pair ids, const Vector3<Real>& impulse) {
    const Vector3<Real> moment = normal.cross(impulse);
    rate_a = turned(bodies, ids.a, rate_a, ball_a, -arm_a * moment);
    rate_b = turned(bodies, ids.b, rate_b, ball_b, -arm_b * moment);
  }

 private:
  SIM_HD static Vector3<Real> turned(const BodyView<Real>& bodies, std::uint32_t body,
                                     const Vector3<Real>& rate, Real ball, const Vector3<Real>& moment) {
    if (ball >= 0) return rate + ball * moment;
    Spin<Real> spin = Spin<Real>::of(bodies, body);
    spin.rate = rate;
    spin.turn(moment);
    return spin.rate;
  }
};

}  // namespace collidoscope

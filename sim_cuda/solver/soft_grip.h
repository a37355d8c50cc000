#pragma once
// What friction gives at one contact of `soft_step`: solved after the normal impulse whenever that is
// relaxed, within mu times it, and, where it bounced, once more after all bounces, within mu times the normal
// impulse of the whole step, for a bounce presses harder than the substep in which it began.

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/solver/friction.h"
#include "sim_cuda/solver/soft_contact.h"
#include "sim_cuda/solver/soft_memory.h"

namespace collidoscope {

/// Beside each SoftContact.
template <class Real>
struct SoftGrip {
  Vector3<Real> impulse;  ///< N s, across the normal, given to b and taken from a; of the substep
  Vector3<Real> total;    ///< N s, of the step so far
  Real coefficient;       ///< of the pair
};

/// Two bodies at a contact. The arms end in the middle of the overlap, so that what friction gives to both
/// leaves their angular momentum as it is.
template <class Real>
struct RubbedPair {
  Vector3<Real> rate_a, rate_b;  ///< rad/s
  Vector3<Real> normal;
  Real arm_a, arm_b;    ///< m
  Real ball_a, ball_b;  ///< as TurnedBodies' eases

  SIM_HD RubbedPair(const Vector3<Real>& spin_a, const Vector3<Real>& spin_b,
                    const SoftContact<Real>& contact, const ContactBodies<Real>& of,
                    const TurnedBodies<Real>& turned)
      : rate_a(spin_a),
        rate_b(spin_b),
        normal(contact.normal),
        arm_a(of.radius_a + contact.gap / 2),
        arm_b(of.radius_b + contact.gap / 2),
        ball_a(turned.ease_a),
        ball_b(turned.ease_b) {}

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

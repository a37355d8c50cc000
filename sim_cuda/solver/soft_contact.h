#pragma once
// One contact of `soft_step`: a spring and damper that is stiff for the substep at hand, so that overlap goes
// away at a bounded speed; without the spring ("relaxed"), so that no speed stays that overlap gave; and,
// once in a step, its bounce. Equations: Catto, "Solver2D" (2024), Soft Step.

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

/// How stiff a contact is in a substep of h seconds: frequency omega (rad/s) and damping ratio zeta as
/// coefficients of implicit Euler, which is stable for all of them.
template <class Real>
struct Softness {
  Real inverse_h;              ///< 1/s
  Real bias_rate;              ///< 1/s, omega / (2 zeta + h omega)
  Real mass_scale;             ///< a / (1 + a), a = h omega (2 zeta + h omega)
  Real impulse_scale;          ///< 1 / (1 + a)
  Real correction_per_radius;  ///< 1/s: overlap goes at no more than so many radii of the smaller sphere a
                               ///< second

  // The stiffest and least damped at which columns and piles were found to come to rest. A contact at rest
  // yields by load / (mass omega^2): at a quarter of a turn a substep by a quarter of what an eighth, the
  // usual value, would make of it; at half a turn, a column of 20 under a mass of 100 flies apart.
  static constexpr double cycles_per_substep = 0.25;
  static constexpr double damping_ratio = 5;
  /// Less than some 5 could not carry that mass.
  static constexpr double correction_limit = 10;

  static Softness of(Real h) {
    const Real full_circle = Real(6.283185307179586), zeta = Real(damping_ratio);
    const Real angle = full_circle * Real(cycles_per_substep);  // h omega
    const Real a1 = 2 * zeta + angle, a2 = angle * a1;
    return {1 / h, angle / (h * a1), a2 / (1 + a2), 1 / (1 + a2), Real(correction_limit)};
  }
};

/// A contact at hand; how it lies in memory: contact_storage.h.
template <class Real>
struct SoftContact {
  Vector3<Real> normal;  ///< unit, from a to b
  Real gap;              ///< m, < 0 where they overlap
  Real impulse;          ///< N s, of the substep, >= 0
  Real total;            ///< N s, of the step so far
  Real approach;         ///< m/s, at which they came together; of no meaning before total > 0; < 0: bounced
  Real radius;           ///< m, of the smaller sphere

  /// How much more impulse this contact gives, N s, where the bodies part at `speed` m/s and `mass` is what
  /// it works against, kg. `soft`: with the spring. Relaxing, without it, begins no contact ahead of the move
  /// that closes it: what is to bounce bounces where it touches.
  template <bool soft>
  SIM_HD Real solve(Real speed, Real mass, const Softness<Real>& softness) {
    Real bias = 0, scale = 1, impulse_scale = 0;
    if (gap > 0) {
      if (!soft && !(impulse > 0)) return 0;
      bias = gap * softness.inverse_h;  // may close, and not more
    } else if (soft) {
      bias = max_of(softness.mass_scale * softness.bias_rate * gap, -softness.correction_per_radius * radius);
      scale = softness.mass_scale;
      impulse_scale = softness.impulse_scale;
    }
    const Real next = max_of(impulse - mass * (scale * speed + bias) - impulse_scale * impulse, Real(0));
    const Real change = next - impulse;
    impulse = next;
    return change;
  }

  /// At the end of a substep that leaves b moving at `velocity` relative to a: counts the impulse, or says
  /// how fast they would meet. `reach()` is the sum of their radii, m, and asked for only then.
  template <class Reach>
  SIM_HD void end_substep(const Vector3<Real>& velocity, const Reach& reach) {
    total += impulse;
    if (!(total > 0)) approach = impact_speed(velocity, reach());
  }

  /// m/s along the normal that they will have where they touch, if both go on straight; 0 where they part or
  /// miss each other. Of a glancing impact it is less than along today's normal, and no bounce may gain.
  SIM_HD Real impact_speed(const Vector3<Real>& velocity, Real reach) const {
    const Real speed = -velocity.dot(normal);
    if (!(speed > 0) || !(gap > 0)) return max_of(speed, Real(0));
    const Real distance = reach + gap;
    const Real squared =
        distance * speed * distance * speed - velocity.dot(velocity) * gap * (distance + reach);
    using std::sqrt;
    return squared > 0 ? sqrt(squared) / reach : Real(0);
  }

  /// Whether b, moving at `velocity` relative to a, gets by a or does not reach it in `time` s; they are
  /// apart now.
  SIM_HD bool passes(const Vector3<Real>& velocity, Real reach, Real time) const {
    const Real distance = reach + gap, speed = -velocity.dot(normal);
    if (!(speed > 0)) return true;
    const Real closed = gap * (distance + reach);
    const Real squared = distance * speed * distance * speed - velocity.dot(velocity) * closed;
    using std::sqrt;
    return !(squared > 0) || closed > time * (distance * speed + sqrt(squared));
  }

  SIM_HD bool bounced() const { return approach < 0; }

  /// The impulse of the bounce, N s, >= 0; `e` is the pair's coefficient, 0 where it does not bounce. What
  /// has bounced parts, and starts the next step from nothing.
  SIM_HD Real bounce(Real speed, Real mass, Real e) {
    const Real bounce_speed = e * approach;
    if (!(total > 0 && bounce_speed > 0 && bounce_speed > speed)) return 0;
    const Real change = mass * (bounce_speed - speed);
    total += change;
    impulse = 0;
    approach = -1;
    return change;
  }
};

}  // namespace collidoscope

#pragma once
// One contact of `soft_step`. In solve it is a soft constraint: a spring and damper, stiff on the scale of
// the substep, that removes overlap at a bounded speed. In relax it has no spring, which removes the
// velocity added by overlap. Restitution is applied once per step. Equations: Catto, "Solver2D" (2024),
// Soft Step.

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

/// Soft-constraint coefficients for a substep of h seconds, from frequency omega (rad/s) and damping ratio
/// zeta. They are those of implicit Euler, which is stable for all values.
template <class Real>
struct Softness {
  Real inverse_h;              ///< 1/s
  Real bias_rate;              ///< 1/s, omega / (2 zeta + h omega)
  Real mass_scale;             ///< a / (1 + a), a = h omega (2 zeta + h omega)
  Real impulse_scale;          ///< 1 / (1 + a)
  Real correction_per_radius;  ///< 1/s: limit of the overlap correction, in radii of the smaller sphere per
                               ///< second

  // The stiffest and least damped values with which columns and piles came to rest in tests. A contact at
  // rest yields by load / (mass omega^2). At 1/4 turn per substep this is a quarter of the yield at 1/8,
  // the usual value. At 1/2, a column of 20 under a mass of 100 flies apart.
  static constexpr double cycles_per_substep = 0.25;
  static constexpr double damping_ratio = 5;
  /// Values below about 5 cannot carry that mass.
  static constexpr double correction_limit = 10;

  static Softness of(Real h) {
    const Real full_circle = Real(6.283185307179586), zeta = Real(damping_ratio);
    const Real angle = full_circle * Real(cycles_per_substep);  // h omega
    const Real a1 = 2 * zeta + angle, a2 = angle * a1;
    return {1 / h, angle / (h * a1), a2 / (1 + a2), 1 / (1 + a2), Real(correction_limit)};
  }
};

/// A contact during an iteration. Memory layout: contact_storage.h.
template <class Real>
struct SoftContact {
  Vector3<Real> normal;  ///< unit, from a to b
  Real gap;              ///< m, < 0 if the bodies overlap
  Real impulse;          ///< accumulated in the substep, N s, >= 0
  Real total;            ///< sum over the step so far, N s
  Real approach;         ///< approach speed, m/s; undefined before total > 0; < 0: has bounced
  Real radius;           ///< m, of the smaller sphere

  /// Solves the normal constraint. Updates the accumulated impulse and returns its change, N s. `speed`:
  /// separation speed along the normal, m/s. `mass`: effective mass, kg. `soft`: solve with the spring.
  ///
  /// Without `soft`, a speculative contact without impulse stays inactive, so restitution applies where the
  /// bodies touch.
  template <bool soft>
  SIM_HD Real solve(Real speed, Real mass, const Softness<Real>& softness) {
    Real bias = 0, scale = 1, impulse_scale = 0;
    if (gap > 0) {
      if (!soft && !(impulse > 0)) return 0;
      bias = gap * softness.inverse_h;  // the gap may close, but not become negative
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

  /// Ends a substep after which b moves at `velocity` relative to a, m/s. Adds the impulse to `total`, and
  /// updates `approach` while total is 0. `reach()`: sum of the radii, m; called only if needed.
  template <class Reach>
  SIM_HD void end_substep(const Vector3<Real>& velocity, const Reach& reach) {
    total += impulse;
    if (!(total > 0)) approach = impact_speed(velocity, reach());
  }

  /// Normal speed at impact, m/s, if both bodies move on in straight lines; 0 if they separate or miss. For
  /// a glancing impact it is below the speed along the current normal, so restitution adds no energy.
  SIM_HD Real impact_speed(const Vector3<Real>& velocity, Real reach) const {
    const Real speed = -velocity.dot(normal);
    if (!(speed > 0) || !(gap > 0)) return max_of(speed, Real(0));
    const Real distance = reach + gap;
    const Real squared =
        distance * speed * distance * speed - velocity.dot(velocity) * gap * (distance + reach);
    using std::sqrt;
    return squared > 0 ? sqrt(squared) / reach : Real(0);
  }

  /// True if b, moving at `velocity` relative to a, misses a or does not reach it in `time` s.
  /// Precondition: gap > 0.
  SIM_HD bool passes(const Vector3<Real>& velocity, Real reach, Real time) const {
    const Real distance = reach + gap, speed = -velocity.dot(normal);
    if (!(speed > 0)) return true;
    const Real closed = gap * (distance + reach);
    const Real squared = distance * speed * distance * speed - velocity.dot(velocity) * closed;
    using std::sqrt;
    return !(squared > 0) || closed > time * (distance * speed + sqrt(squared));
  }

  SIM_HD bool bounced() const { return approach < 0; }

  /// Restitution impulse, N s, >= 0. `e`: coefficient of the pair, 0 if it does not bounce. A contact that
  /// bounced separates, so its impulse is reset and not used for warm starting.
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

#pragma once
// One contact of `soft_step`. In solve it is a soft constraint: a spring and damper, stiff on the scale of
// the substep, that removes overlap at a bounded speed. In relax it has no spring, which removes the
// velocity added by overlap. Impacts are resolved before, at the start of the substep (impact.h). Equations:
// Catto, "Solver2D" (2024), Soft Step.

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
  Real passes;                 ///< over all contacts per substep, before the move
  Real correction_per_radius;  ///< 1/s: limit of the overlap correction, in radii of the smaller sphere per
                               ///< second
  Real held_share = 0;         ///< share of the yield to a load that is held back
  Real kept_overlap = 1;       ///< a contact with a load keeps overlap up to this multiple of the load's
  Real over_relaxation = 1;    ///< factor of impulses between split bodies, in passes that others follow

  // The stiffest and least damped values with which columns and piles came to rest in tests. A contact at
  // rest yields by load / (mass omega^2). At 1/4 turn per substep this is a quarter of the yield at 1/8,
  // the usual value. At 1/2, a column of 20 under a mass of 100 flies apart.
  static constexpr double cycles_per_substep = 0.25;
  static constexpr double damping_ratio = 5;
  /// Values below about 5 cannot carry that mass.
  static constexpr double correction_limit = 10;
  /// Contacts without a load recover overlap at this share of the speed. Bodies that overlap after an impact
  /// separate by themselves; a push, and its removal in relax, would change their energy.
  static constexpr double unloaded_share = 0.1;
  /// In scenes with gravity or attractors. A pile overlaps more in its stop than at rest, and would rise in
  /// the seconds after. That recovery also keeps tall piles in motion: 15 s after its fall, the median speed
  /// of 100 layers without friction is 8 mm/s with 2, 7 mm/s with 2.5, and 0.2 mm/s with this value (60
  /// steps/s).
  static constexpr double pulled_kept_overlap = 3;
  /// In scenes with gravity or attractors and without friction, contacts yield more slowly. So piles yield
  /// less to the loads of their stop. If all is held back, bodies at rest never find the overlap of their
  /// load. With friction, bodies would creep on their way to it; without gravity, a rack of touching balls
  /// would lose 0.1 % of its energy.
  static constexpr double sliding_held_share = 0.8;
  /// In the same scenes. In physics version 16, 9 of 60 tall piles of `jacobi_split` exceeded a `push_work`
  /// of 1 % with 1, and 4 of 180 with this value. Not tried alone in other scenes.
  static constexpr double sliding_over_relaxation = 1.6;

  /// For parts of split bodies. `parts`: effective mass of the whole bodies over that of the parts. The
  /// solution then has the stiffness of the whole bodies. Fewer passes than parts cannot reach it, and
  /// columns would sway; so the stiffness grows at most by the number of passes.
  SIM_HD Softness of_parts(Real parts) const {
    const Real a = min_of(parts, passes) * mass_scale / impulse_scale;
    Softness result = *this;
    result.mass_scale = a / (1 + a);
    result.impulse_scale = 1 / (1 + a);
    return result;
  }

  /// `pulled`: SolverScene::limits_recovery(), with gravity or attractors.
  static Softness of(Real h, int passes, bool pulled = false, bool with_friction = false) {
    const Real full_circle = Real(6.283185307179586), zeta = Real(damping_ratio);
    const Real angle = full_circle * Real(cycles_per_substep);  // h omega
    const Real a1 = 2 * zeta + angle, a2 = angle * a1;
    Softness result{1 / h,        angle / (h * a1),          a2 / (1 + a2),
                    1 / (1 + a2), static_cast<Real>(passes), Real(correction_limit)};
    if (!pulled) return result;
    result.kept_overlap = Real(pulled_kept_overlap);
    if (with_friction) return result;
    result.held_share = Real(sliding_held_share);
    result.over_relaxation = Real(sliding_over_relaxation);
    return result;
  }
};

/// Bodies that close a larger gap than this in a substep, m, have an impact in the next substep. Their
/// contact has prevented overlap, and the impulse of that is no load. `acceleration_margin`: largest
/// displacement in a step by gravity and attractors, m.
template <class Real>
Real closing_gap(Real acceleration_margin, int substeps) {
  // A speed of 8 a h, four times that of slow impacts. With 2 a h, tall piles that are stopped lose loads,
  // and overlap recovery lifts them twice as much. With 32 a h, balls rebound at up to 0.08 m/s without
  // restitution.
  constexpr int factor = 8;
  return factor * acceleration_margin / static_cast<Real>(substeps * substeps);
}

/// Impulse of the impacts of a contact in a substep. Without impacts: whether the contact has pressed in this
/// step. One number, because a sweep reads it for every contact.
template <class Real>
struct ImpactSum {
  Real stored;  ///< N s; -1: no impacts, has pressed; -2: the same, and closes a gap in this substep

  static constexpr Real pressed = -1, closing = -2;
  SIM_HD Real impulse() const { return max_of(stored, Real(0)); }
  SIM_HD bool has_pressed() const { return stored < 0; }
  SIM_HD bool is_closing() const { return stored == closing; }
  SIM_HD void add(Real change) { stored = impulse() + change; }
  SIM_HD void end_substep() { stored = min_of(stored, Real(0)); }
};

/// A contact during an iteration. Memory layout: contact_storage.h.
template <class Real>
struct SoftContact {
  Vector3<Real> normal;  ///< unit, from a to b
  Real gap;              ///< m, < 0 if the bodies overlap
  Real impulse;          ///< accumulated in the substep, N s, >= 0
  Real total;            ///< sum over the step so far, impacts included, N s
  ImpactSum<Real> impact;
  Real radius;  ///< m, of the smaller sphere

  /// Solves the normal constraint. Updates the accumulated impulse and returns its change, N s. `speed`:
  /// separation speed along the normal, m/s. `mass`: effective mass, kg. `soft`: solve with the spring.
  ///
  /// Without `soft`, a contact without impulse stays inactive. `first`: in the first pass of a substep. Only
  /// this pass pushes overlapping bodies apart whose contact has no load.
  template <bool soft>
  SIM_HD Real solve(Real speed, Real mass, const Softness<Real>& softness, bool first = true) {
    Real bias = 0, scale = 1, impulse_scale = 0, held = 0;  // held: N s, yield or recovery that is left out
    if (!soft && !(impulse > 0)) return 0;
    if (gap > 0) {
      bias = gap * softness.inverse_h;  // the gap may close, but not become negative
    } else if (soft) {
      bias = max_of(softness.mass_scale * softness.bias_rate * gap, -softness.correction_per_radius * radius);
      // In later passes, an impulse that is no larger than a push is no load.
      const bool loaded = impulse > (first ? Real(0) : -mass * bias);
      if (!loaded && !first && speed >= 0) return 0;
      if (!loaded) bias *= first ? Real(softness.unloaded_share) : Real(0);
      scale = softness.mass_scale;
      impulse_scale = softness.impulse_scale;
      const Real yield = mass * bias + impulse_scale * impulse;  // N s; < 0: recovery
      const Real recovery = min_of(mass * bias + softness.kept_overlap * impulse_scale * impulse, Real(0));
      held = yield > 0 ? softness.held_share * yield : yield - recovery;
    }
    return set(impulse - mass * (scale * speed + bias) - impulse_scale * impulse + held);
  }
  /// Multiplies the last change of the impulse, N s. Returns the new change.
  SIM_HD Real extend(Real change, Real factor) {
    if (factor == 1) return change;
    const Real before = impulse - change;
    set(before + factor * change);
    return impulse - before;
  }
  /// Sets the impulse to `next` if it is positive, else to 0. Returns its change, N s.
  SIM_HD Real set(Real next) {
    const Real before = impulse;
    impulse = max_of(next, Real(0));
    return impulse - before;
  }
  /// Impulse without an effect, N s. For a contact without a load in a pass that others follow: it stays
  /// active, and the load can return.
  static constexpr Real trace = Real(1e-30);

  /// Call before each solve without the spring.
  SIM_HD void mark_pressing() {
    if (impulse > 0 && !impact.is_closing()) impact.stored = ImpactSum<Real>::pressed;
  }
  /// Call after the last solve with the spring. `least_gap`: closing_gap().
  SIM_HD void mark_closing(Real least_gap) {
    if (impulse > 0 && gap > least_gap) impact.stored = ImpactSum<Real>::closing;
  }
  /// Call at the end of a substep. Returns true if the impulse is no load and has been set to 0.
  SIM_HD bool end_substep() {
    total += impulse;
    const bool closing = impact.is_closing();
    if (closing) {
      impulse = 0;
      impact.stored = ImpactSum<Real>::pressed;
    }
    impact.end_substep();
    return closing;
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
};

}  // namespace collidoscope

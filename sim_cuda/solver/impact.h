#pragma once
// Impacts of `soft_step` and `jacobi_split`. At the start of each substep, bodies that will touch within the
// substep get impulses, pair by pair. The contact solver that follows is purely inelastic, and then meets
// only slow approaches.
//
// A pair that approaches at speed u gets the impulse (1 + e) u m, where m is the reduced mass. Kinetic
// energy changes by -(1 - e^2) m u^2 / 2 <= 0. So no sequence of such impulses gains energy. Sweeps over all
// contacts, colour by colour, are repeated until no contact approaches faster than its threshold, at most
// `max_impact_sweeps` times. The remaining approach is inelastic, and is counted as `bounce_cap`.
//
// Against a static surface at distance s, with acceleration a towards it, the rebound speed at the current
// position is sqrt(e^2 (u^2 + 2 a s) - 2 a s). The body is then on the parabola that it would follow after an
// impact at the surface. So the energy is exact if free flight is exact (integrators.h). If the square is
// negative, the rebound does not reach this height: a pair then separates at e u. At a plane, the body is
// moved to the surface and leaves it at e times the speed of arrival. If e < 1, a body without contacts is
// always moved: its impact is early by at most about a substep. On the parabola, it would also skip the time
// in which it returns to its height, at the lower speed. The gaps of contacts are not updated, so bodies with
// contacts stay where they are if they can.
//
// If e = 0, a pair keeps the approach speed s/h, at which it touches at the end of the substep. At planes,
// the contact solver does the same for bodies without contacts.
//
// The threshold grows with the load: 2 a h, where a is the acceleration of the body by gravity and
// attractors, plus a quarter of the speed that the contact's impulse of the last substep gives. A resting
// contact approaches by a h per substep. Without the load, tall columns never rest. Without friction, where
// two passes build up larger loads, there are exceptions. Between a heavy body and a light one, the load is
// the speed that the impulse gives the heavy one. Bodies that a heavy one has hit have none: the impulses
// that stop the heavy body would hide the impacts that remain. If a = 0, the threshold is a fraction of the
// speeds, for rounding. From the third sweep on, 2 a h doubles in each sweep: in a falling pile, ever
// slower impacts would follow each other up to the last sweep. It does not double for heavy bodies on
// light ones that have support, nor at the planes of light bodies that heavy ones have hit. Nor if e = 0,
// except between a heavy body and a light one: what remains of an inelastic impact becomes load, and
// throws bodies up in the next substep. A heavy body needs that load: without it, a column under the body
// is pressed together.
//
// Smith et al., "Reflections on simultaneous impact" (2012), compare this with simultaneous reflections,
// which keep symmetries and need an inner solve.

#include <cstdint>

#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/solver/contacts_by_body.h"
#include "sim_cuda/solver/restitution.h"
#include "sim_cuda/solver/shock.h"
#include "sim_cuda/solver/soft_iteration.h"

namespace collidoscope {

/// Largest number of sweeps over all contacts in a substep.
inline constexpr int max_impact_sweeps = 16;

template <class Real>
struct ImpactLaw {
  Restitution<Real> restitution;
  Vector3<Real> gravity;       ///< m/s^2
  const Vector3<Real>* field;  ///< acceleration by attractors, m/s^2, by body; null if the effect is off
  Real h;                      ///< substep, s
  Real slow;                   ///< m/s: slower approaches have no impact

  static constexpr double load_share = 0.25;
  /// From this sweep on, the part by the acceleration doubles in each sweep.
  static constexpr int first_growing_sweep = 2;
  /// Approach speeds below this fraction of the bodies' speeds are rounding.
  static constexpr Real rounding = sizeof(Real) == 4 ? Real(1e-5) : Real(1e-7);

  /// Contacts that touch within this time have an impact, s. More than h, so that rounding leaves no contact
  /// to the inelastic solver.
  SIM_HD Real reach_time() const { return h * Real(1.0625); }
  /// By gravity and attractors, m/s^2.
  SIM_HD Vector3<Real> acceleration(std::uint32_t body) const {
    return field != nullptr ? Vector3<Real>(gravity + field[body]) : gravity;
  }
  /// m/s; `a`: acceleration of the body, m/s^2.
  SIM_HD Real rest_speed(const Vector3<Real>& a) const {
    using std::sqrt;
    return 2 * h * sqrt(a.dot(a));
  }
  /// Factor of rest_speed() in a sweep.
  SIM_HD static Real growth(int sweep) {
    return sweep < first_growing_sweep ? Real(1) : static_cast<Real>(2 << (sweep - first_growing_sweep));
  }
  /// `rest`: rest_speed(), m/s. `speed`: sum of the speeds, m/s. `load_speed`: change of the speed of
  /// approach by the impulse of the last substep, m/s.
  SIM_HD Real threshold(Real rest, Real speed, Real load_speed) const {
    return max_of(rest, rounding * speed) + Real(load_share) * load_speed;
  }
  /// Separation speed after an impact, m/s, at the same distance; 0 or less if the rebound does not reach it.
  /// `approach`, m/s, at distance `gap` >= 0, m. `acceleration`: towards the surface, m/s^2. `e`: of the
  /// pair.
  SIM_HD Real separation(Real approach, Real gap, Real acceleration, Real e) const {
    if (e == 1 || !(gap * acceleration != 0)) return e * approach;
    return rebound_speed(approach, gap, acceleration, e);
  }
};

/// Marks of what a sweep tests. A value is 2 + the last sweep in which a velocity changed; 1: fast; 0: slow.
struct StruckMarks {
  std::uint8_t* body;     ///< by body
  std::uint8_t* contact;  ///< by place: the larger value of its bodies, from 2 on. Only on the CPU, else null
  ContactsByBodyView contacts_of;  ///< places, by body
  const StepControl* control;

  SIM_HD bool of_contacts() const { return contact != nullptr; }
  SIM_HD void set(std::uint32_t id, std::uint8_t now) const {
#if !defined(__CUDA_ARCH__)
    if (of_contacts() && control->contacts > 0 && atomic_load(body + id) != now)
      for (std::uint32_t k = 0; k < contacts_of.count[id]; ++k)
        atomic_store(contact + contacts_of.end(static_cast<int>(id), k).contact, now);
#endif
    atomic_store(body + id, now);
  }
  /// Call at the end of a substep.
  SIM_HD void clear_contacts() const {
    for (std::uint32_t place = 0; of_contacts() && place < control->contacts; ++place) contact[place] = 0;
  }
};

/// The act of an impact sweep.
template <class Real, bool with_friction, bool unequal_moments>
struct Impact {
  static constexpr bool has_friction = with_friction, mostly_idle = true,
                        has_unequal_moments = unequal_moments;
  ImpactLaw<Real> law;
  std::uint32_t* again;  ///< set to 1 if a contact gets an impulse: another sweep is needed
  StruckMarks struck;
  ShockMarks shocks;
  StaticImpulse* static_impulses;         ///< by body, or null
  std::uint8_t now;                       ///< 2 + the number of this sweep
  const std::uint32_t* needed = nullptr;  ///< 0: the sweep is not needed; or null

  SIM_HD bool is_needed() const { return needed == nullptr || atomic_load(needed) != 0; }
  SIM_HD int sweep() const { return now - 2; }

  /// Impact of a heavy body on a supported light one (shock.h). Returns true if the heavy body got an
  /// impulse. Only contacts that would have an impact without it: most sweeps skip the others.
  SIM_HD bool shock(SoftContact<Real>& contact, const Pair& ids, const ContactBodies<Real>& bodies,
                    Vector3<Real>& v_a, Vector3<Real>& v_b) const {
    if (sweep() < ShockMarks::first_sweep || !(contact.impact.impulse() > 0)) return false;
    const Real w_a = bodies.inverse_mass_a, w_b = bodies.inverse_mass_b;
    if (!shocks.is_shock_pair(ids, w_a, w_b, sweep())) return false;
    if (normal_change(contact, Motions<Real>{ids, bodies, v_a, v_b, 1 / (w_a + w_b), 1}) == 0) return false;
    const bool a_heavy = w_a < w_b;
    const std::uint32_t heavy = a_heavy ? ids.a : ids.b;
    const Vector3<Real> to_light = a_heavy ? contact.normal : Vector3<Real>(-contact.normal);
    Vector3<Real>& v = a_heavy ? v_a : v_b;
    // The velocity of a light body that comes towards the heavy one does not count.
    const Real approach = v.dot(to_light) - max_of((a_heavy ? v_b : v_a).dot(to_light), Real(0));
    using std::sqrt;
    const Real speeds = sqrt(v_a.dot(v_a)) + sqrt(v_b.dot(v_b)), gap = max_of(contact.gap, Real(0));
    const Vector3<Real> pull = law.acceleration(heavy);
    const Real load_speed = speed_of_load(contact.impulse, ids, w_a, w_b);
    if (!(approach > law.threshold(law.rest_speed(pull), speeds, load_speed))) return false;
    if (gap > 0 && misses(contact, bodies.radius_a + bodies.radius_b, Vector3<Real>(v_b - v_a),
                          Vector3<Real>(Vector3<Real>::Zero())))
      return false;
    const Real e = law.restitution.of_pair(ids, approach);
    // A light body that gives way approaches more slowly in each sweep. Then the mean approach so far is much
    // larger.
    const Real mean = contact.impact.impulse() * (w_a + w_b) / ((1 + e) * static_cast<Real>(sweep()));
    if (-(v_b - v_a).dot(contact.normal) < Real(ShockMarks::blocked_share) * mean) return false;
    const Real velocity_change = approach + (e > 0 ? e * approach : -gap / law.h);
    if (!(velocity_change > 0)) return false;
    const Real change = velocity_change / (a_heavy ? w_a : w_b);
    v -= velocity_change * to_light;
    contact.impact.add(change);
    contact.total += change;
    contact.impulse = e > 0 ? Real(0) : max_of(contact.impulse - change, Real(0));
    if (static_impulses != nullptr) {
      add_in_turn(&static_impulses[heavy].impulse, static_cast<double>(change));
      for (int k = 0; k < 3; ++k)
        add_in_turn(&static_impulses[heavy].vector[k], -static_cast<double>(change * to_light[k]));
    }
    atomic_store(again, std::uint32_t{1});
    return true;
  }
  SIM_HD Real solve_normal(SoftContact<Real>& contact, const Motions<Real>& motions) const {
    const Real change = normal_change(contact, motions);
    if (change == 0) return 0;
    contact.impact.add(change);
    contact.total += change;
    const bool rebounds = law.restitution.of_pair(motions.ids, -motions.velocity().dot(contact.normal)) > 0;
    contact.impulse = rebounds ? Real(0) : max_of(contact.impulse - change, Real(0));
    atomic_store(again, std::uint32_t{1});
    return change;
  }
  /// Impulse of an impact, N s, or 0.
  SIM_HD Real normal_change(const SoftContact<Real>& contact, const Motions<Real>& motions) const {
    const Vector3<Real> velocity = motions.velocity();
    const Real approach = -velocity.dot(contact.normal);
    if (!(approach > law.slow)) return 0;
    const ContactBodies<Real>& bodies = motions.bodies;
    const Vector3<Real> zero = Vector3<Real>::Zero();
    const Vector3<Real> a_a = bodies.inverse_mass_a > 0 ? law.acceleration(motions.ids.a) : zero,
                        a_b = bodies.inverse_mass_b > 0 ? law.acceleration(motions.ids.b) : zero;
    const Real w_a = bodies.inverse_mass_a, w_b = bodies.inverse_mass_b;
    Real rest = max_of(law.rest_speed(a_a), law.rest_speed(a_b));
    using std::sqrt;
    const Real speed = sqrt(motions.v_a.dot(motions.v_a)) + sqrt(motions.v_b.dot(motions.v_b));
    const Real load_speed = speed_of_load(contact.impulse, motions.ids, w_a, w_b);
    if (!(approach > law.threshold(rest, speed, load_speed))) return 0;
    const Real e = law.restitution.of_pair(motions.ids, approach);
    if (sweep() >= law.first_growing_sweep && (e > 0 || ShockMarks::has_heavy(w_a, w_b)) &&
        !shocks.is_shock_pair(motions.ids, w_a, w_b, sweep())) {
      rest *= law.growth(sweep());
      if (!(approach > law.threshold(rest, speed, load_speed))) return 0;
    }
    const Vector3<Real> pull = a_b - a_a;
    if (contact.gap > 0 && misses(contact, motions.reach(), velocity, pull)) return 0;
    const Real gap = max_of(contact.gap, Real(0));
    Real separation = -gap / law.h;
    if (e > 0) {
      separation = law.separation(approach, gap, -pull.dot(contact.normal), e);
      if (!(separation > 0)) separation = e * approach;
    } else if (!(approach + separation > rest + law.rounding * speed)) {
      return 0;
    }
    return motions.mass * (approach + separation);
  }
  template <class Mass>
  SIM_HD Vector3<Real> solve_tangent(const SoftContact<Real>& contact, FrictionImpulse<Real>& friction,
                                     const Vector3<Real>& slip, const Mass& mass) const {
    if (!(contact.impulse > 0)) friction.impulse = Vector3<Real>::Zero();
    return solve_friction<Real>(slip, mass, friction.coefficient * contact.impact.impulse(), friction.impact);
  }
  /// Friction acts during an impact. Bodies that later slide on each other again, because of other impacts,
  /// are separating.
  SIM_HD static bool has_tangent(const SoftContact<Real>&, const FrictionImpulse<Real>&, Real change) {
    return change != 0;
  }
  SIM_HD static bool finish(SoftContact<Real>&, FrictionImpulse<Real>&) { return false; }
  SIM_HD static bool changes_sums(const SoftContact<Real>&, bool) { return true; }

  /// Call if the contact has changed the velocities of its bodies. Static bodies may have other contacts in
  /// the same round, and do not change.
  SIM_HD void mark(const Pair& ids, const ContactBodies<Real>& bodies, const Vector3<Real>& v_a,
                   const Vector3<Real>& v_b) const {
    const Real w_a = bodies.inverse_mass_a, w_b = bodies.inverse_mass_b;
    if (w_a > 0) {
      struck.set(ids.a, now);
      shocks.add_impact(ids.a, w_a, ids.b, w_b, v_b.dot(v_b) > 0, sweep());
    }
    if (w_b > 0) {
      struck.set(ids.b, now);
      shocks.add_impact(ids.b, w_b, ids.a, w_a, v_a.dot(v_a) > 0, sweep());
    }
  }

 private:
  /// See the head of this file. `impulse`: of the last substep, N s; `w_a`, `w_b`: inverse masses, 1/kg.
  SIM_HD Real speed_of_load(Real impulse, const Pair& ids, Real w_a, Real w_b) const {
    if constexpr (with_friction) return impulse * (w_a + w_b);
    if (!(impulse > 0) || shocks.is_driven(ids.a, sweep()) || shocks.is_driven(ids.b, sweep())) return 0;
    return impulse * (ShockMarks::has_heavy(w_a, w_b) ? min_of(w_a, w_b) : w_a + w_b);
  }
  /// True if the bodies do not touch in the substep, neither in free flight nor in a step of Euler's method.
  SIM_HD bool misses(const SoftContact<Real>& contact, Real reach, const Vector3<Real>& velocity,
                     const Vector3<Real>& pull) const {
    const Real time = law.reach_time();
    if (!contact.passes(velocity + (law.h / 2) * pull, reach, time)) return false;
    return pull.dot(pull) == 0 || contact.passes(velocity + law.h * pull, reach, time);
  }
};

}  // namespace collidoscope

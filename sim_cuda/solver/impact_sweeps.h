#pragma once
// The impact sweeps of a substep (impact.h), as rounds of a stage.
//
// Most sweeps change few bodies: after the third one, 400 of 50,000 falling spheres, after the sixth 40. On a
// GPU, such sweeps would take the time of their grid barriers, up to 33 each. So when few bodies are left,
// one block runs the remaining sweeps alone, over lists of these bodies and of their contacts
// (last_impact_sweeps.h). The result is the same bit for bit.

#include <cstdint>

#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/round_kernels.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/solver/chain_contacts.h"
#include "sim_cuda/solver/colouring.h"
#include "sim_cuda/solver/impact.h"
#include "sim_cuda/solver/last_impact_sweeps.h"
#include "sim_cuda/solver/plane_impacts.h"

namespace collidoscope {

/// Impact sweeps of a substep from sweep `first` on, for Executor::run_rounds. Each sweep: planes and boxes
/// of all bodies, then contacts as in an Iteration. Sweep 0 tests all bodies at their planes, and contacts of
/// bodies faster than half of the threshold. A later sweep tests the bodies whose velocity has changed since
/// the last sweep, and their contacts; the result is that of testing all.
template <class Real, bool with_friction, bool with_box_obstacles, bool unequal_moments>
struct ImpactSweeps {
  using Number = Real;
  using Contacts = Iteration<Real, Impact<Real, with_friction, unequal_moments>>;
  static constexpr int rounds_per_sweep = Contacts::rounds + 1;
  static constexpr int most_threads =
      384;  // measured, H200: sweeps of 300,000 bodies take 35 % less than with 1024
  static constexpr bool has_short_rest = true;
  SIM_HD int rounds() const { return (max_impact_sweeps - first) * rounds_per_sweep; }

  Contacts contacts;
  SoftWalls<Real, with_friction, with_box_obstacles> walls;
  std::uint32_t* needed;       ///< by sweep, max_impact_sweeps + 1 flags, 0 before the substep
  const std::uint8_t* asleep;  ///< by body, or null
  StepControl* control;
  int first;
  LastSweepLists last;  ///< null on the CPU

  SIM_HD std::int64_t items(int round) const {
    const int sweep = first + round / rounds_per_sweep, part = round % rounds_per_sweep - 1;
    if (sweep == 0 && part < 0) return control->overflow ? 0 : walls.body_count;
    if (atomic_load(needed + sweep) == 0) return -1;
    if (part >= 0) return contacts.items(part);
    return walls.count() > 0 || last.on() ? walls.body_count : 0;
  }
  /// True if one block can run the rest of the sweep of `round`, and the sweeps after it, faster than all
  /// blocks. See RoundsWithShortRest.
  SIM_HD bool rest_is_short(int round) const {
    if (!last.on() || round % rounds_per_sweep != 0 || contacts.items(Colouring::colours) > 0) return false;
    const int sweep = first + round / rounds_per_sweep;
    return sweep >= LastSweepLists::first_sweep && last.size(sweep) <= LastSweepLists::most_bodies;
  }
#if defined(__CUDACC__)
  __device__ void run_rest(int round) const { run_last_sweeps(*this, first + round / rounds_per_sweep); }
#endif
  SIM_HD void operator()(int round, int item) const {
    const int sweep = first + round / rounds_per_sweep, part = round % rounds_per_sweep - 1;
    if (part < 0) return bounce_off_walls(sweep, item);
    if (is_tested(sweep, part, item)) run_item(contacts_in(sweep), part, item);
  }
  SIM_HD bool is_tested(int sweep, int part, int item) const {
    if (part >= Colouring::colours) return true;
    const std::uint32_t place = contacts.contacts.begin[part] + static_cast<std::uint32_t>(item);
    const Pair ids = contacts.contacts.ids[place];
    const std::uint8_t* const struck = contacts.act.struck.body;
    if (max_of(struck[ids.a], struck[ids.b]) < sweep + 1) return false;
    return approaches(sweep, ids, contacts.contacts.soft[place].normal);
  }
  /// Most contacts do not approach. Their other data are not loaded.
  SIM_HD bool approaches(int sweep, const Pair& ids, const Vector3<Real>& normal) const {
    const BodyView<Real>& bodies = contacts.bodies;
    const Vector3<Real> velocity = bodies.velocity[ids.b].load() - bodies.velocity[ids.a].load();
    const ImpactLaw<Real>& law = contacts.act.law;
    const Real approach = -velocity.dot(normal);
    if (approach > law.slow * law.growth(sweep)) return true;
    return approach > law.slow && (!(law.restitution.of_pair(ids, approach) > 0) ||
                                   contacts.act.shocks.is_shock_pair(ids, bodies.inverse_mass[ids.a],
                                                                     bodies.inverse_mass[ids.b], sweep));
  }
  SIM_HD Contacts contacts_in(int sweep) const {
    Contacts now = contacts;
    now.act.again = needed + sweep + 1;
    now.act.now = static_cast<std::uint8_t>(sweep + 2);
    return now;
  }

  /// A round on the CPU; see MarkedRounds.
  struct Round {
    ImpactSweeps sweeps;
    Contacts contacts;
    int sweep, part;  ///< part -1: planes and boxes
    void operator()(int item) const {
      if (part < 0) return sweeps.bounce_off_walls(sweep, item);
      if (sweeps.is_tested(sweep, part, item)) run_item(contacts, part, item);
    }
    ItemMarks marks() const {
      const StruckMarks& struck = contacts.act.struck;
      if (sweep == 0 || part >= Colouring::colours || !struck.of_contacts()) return {};
      return {part < 0 ? struck.body : struck.contact + contacts.contacts.begin[part],
              static_cast<std::uint8_t>(sweep + 1)};
    }
  };
  Round round(int number) const {
    const int sweep = first + number / rounds_per_sweep;
    return {*this, contacts_in(sweep), sweep, number % rounds_per_sweep - 1};
  }

  /// The first round of a sweep.
  SIM_HD void bounce_off_walls(int sweep, int id) const {
    const StruckMarks& struck = contacts.act.struck;
    if (asleep != nullptr && asleep[id] != 0) {
      struck.body[id] = 0;
      return;
    }
    if (sweep > 0 && struck.body[id] < sweep + 1) return;
    last.add(static_cast<std::uint32_t>(id), sweep);
    const Vector3<Real> v = walls.bodies.velocity[id];
    const ImpactLaw<Real>& law = contacts.act.law;
    const Vector3<Real> pull = law.acceleration(static_cast<std::uint32_t>(id));
    const ShockMarks& shocks = contacts.act.shocks;
    if (sweep == 0) shocks.clear(static_cast<std::uint32_t>(id));
    const bool driven = sweep > 0 && shocks.is_driven(static_cast<std::uint32_t>(id), sweep);
    const Real rest = law.rest_speed(pull), limit = rest / 2, growth = driven ? Real(1) : law.growth(sweep);
    if (sweep == 0) {
      const bool fast = v.dot(v) > Real(0.99) * limit * limit;  // less than the limit, for rounding
      struck.body[id] = fast ? 1 : 0;
      if (fast) atomic_store(needed, std::uint32_t{1});
    }
    if (walls.count() == 0 || !(walls.bodies.inverse_mass[id] > 0)) return;
    if (sweep == 0) walls.clear_bounced(id);
    if (!(v.dot(v) > limit * limit)) return;
    typename SoftWalls<Real, with_friction, with_box_obstacles>::Body body = walls.load_motion(id);
    const PlaneImpacts<Real, with_friction, with_box_obstacles> impacts{walls, law, pull, rest};
    if (!impacts.may_bounce(body)) return;
    walls.load_rest(id, body);
    const bool may_shift = control->contacts == 0 || struck.contacts_of.count[id] == 0;
    if (!impacts.template resolve<unequal_moments>(id, body, growth, may_shift, driven)) return;
    walls.store(id, body);
    struck.set(static_cast<std::uint32_t>(id), static_cast<std::uint8_t>(sweep + 2));
    shocks.support(static_cast<std::uint32_t>(id), sweep);
    atomic_store(needed + sweep + 1, std::uint32_t{1});
    if (sweep == 0) atomic_store(needed, std::uint32_t{1});
  }
};

/// The first round of sweep `first`, for planes and boxes, as a stage.
template <class Sweeps>
struct FirstRound {
  Sweeps sweeps;
  SIM_HD void operator()(int id) const {
    if (id < sweeps.items(0)) sweeps(0, id);
  }
};

/// Ends the impacts of a substep: counts a substep that needed more sweeps, and clears the flags and
/// counters.
struct EndImpacts {
  std::uint32_t* needed;  ///< see ImpactSweeps; then a flag that stays: a body was fast or had an impact
  LastSweepLists last;
  StruckMarks struck;
  std::uint32_t* chain_counts;  ///< ChainView::count; null: no chains
  StepControl* control;
  SIM_HD void operator()(int) const {
    struck.clear_contacts();
    if (needed[max_impact_sweeps] != 0) ++control->bounce_caps;
    needed[max_impact_sweeps + 1] = needed[0];
    for (int sweep = 0; sweep <= max_impact_sweeps; ++sweep) needed[sweep] = 0;
    last.clear();
    for (int k = 0; chain_counts != nullptr && k < ChainView::counts; ++k) chain_counts[k] = 0;
  }
};

}  // namespace collidoscope

#pragma once
// More passes over chain contacts (chain_contacts.h), before the passes of `solve` and of `relax` over all
// contacts. They act where bodies move: an impact must reach the other end of a column, or its loads stay too
// small. The column is then pressed together and lifted again, which adds energy (`push_work`).
//
// Of 2,800 columns of 2 to 30 falling balls, 500 had a `push_work` above 1 % without these passes (physics
// version 19). Such passes over all contacts that move do the same, but then piles that fall take 20 %
// longer.

#include <cstdint>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/solver/chain_contacts.h"
#include "sim_cuda/solver/soft_iteration.h"
#include "sim_cuda/solver/soft_wall_stages.h"

namespace collidoscope {

/// An act of an Iteration whose impulses change by a multiple (successive over-relaxation): one such pass
/// does about as much as two. A pass without it must follow. Contacts that lose their impulse stay active.
template <class Act>
struct OverRelaxed : Act {
  static constexpr double factor = 1.7;
  template <class Real>
  SIM_HD Real solve_normal(SoftContact<Real>& contact, const Motions<Real>& motions) const {
    const Real before = contact.impulse;
    const Real change = contact.extend(Act::solve_normal(contact, motions), Real(factor));
    if (!(before > 0) || contact.impulse > 0) return change;
    return contact.set(SoftContact<Real>::trace) + change;
  }
};

/// For Executor::run_rounds. A pass has a round for each colour of chains, then one for the planes and boxes
/// of chain bodies.
template <class Real, class Act, class Walls>
struct ChainPasses {
  using Contacts = Iteration<Real, OverRelaxed<Act>>;
  static constexpr bool static_item_counts = true;
  static constexpr int passes = 4, rounds_per_pass = ChainView::counts, rounds = passes * rounds_per_pass;

  Contacts contacts;
  Walls walls;
  ChainView chains;
  const std::uint8_t* struck;  ///< see MovingContacts

  /// ChainView::of_bodies: planes and boxes.
  SIM_HD static int part(int round) { return round % rounds_per_pass; }
  SIM_HD std::int64_t items(int round) const {
    const int now = part(round);
    return now < ChainView::colours || walls.count() > 0 ? read_only(chains.count + now) : 0;
  }
  SIM_HD void operator()(int round, int item) const {
    const int now = part(round);
    if (now == ChainView::of_bodies) {
      const auto body = static_cast<int>(chains.bodies[item]);
      if (walls.is_near(body)) walls(body);
      return;
    }
    const std::uint32_t place =
        chains.places[read_only(contacts.contacts.begin + now) + static_cast<std::uint32_t>(item)];
    if (acts(place)) contacts(contacts.fetch(place));
  }
  /// Contacts of bodies that an impact has changed, and contacts of fast bodies that are loaded now. Not
  /// those that close a gap: their impulse is no load, and too much of it throws bodies up.
  SIM_HD bool acts(std::uint32_t place) const {
    if (contacts.contacts.sums[place].impact.is_closing()) return false;
    const Pair ids = contacts.contacts.ids[place];
    return max_of(struck[ids.a], struck[ids.b]) > 1 || contacts.contacts.soft[place].impulse > 0;
  }
};

}  // namespace collidoscope

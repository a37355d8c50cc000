#pragma once
// More passes over chain contacts (chain_contacts.h), before the passes of `solve` and of `relax` over all
// contacts. They act where bodies move: an impact must reach the other end of a column, or its loads stay too
// small. The column is then pressed together and lifted again, which adds energy (`push_work`).
//
// Of 1,000 columns of 2 to 30 falling balls, 172 had a `push_work` above 1 % without these passes, and 2 have
// with them. Such passes over all contacts that move do the same, but then piles that fall take 20 % longer.

#include <cstdint>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/solver/chain_contacts.h"
#include "sim_cuda/solver/soft_iteration.h"
#include "sim_cuda/solver/soft_wall_stages.h"

namespace collidoscope {

/// An act of an Iteration whose impulses change by a multiple (successive over-relaxation): one such pass
/// does about as much as two. A pass without it must follow.
template <class Act>
struct OverRelaxed : Act {
  static constexpr double factor = 1.7;
  template <class Real>
  SIM_HD Real solve_normal(SoftContact<Real>& contact, const Motions<Real>& motions) const {
    return contact.extend(Act::solve_normal(contact, motions), Real(factor));
  }
};

/// For Executor::run_rounds. A pass has a round per colour, and one for the planes and boxes of chain bodies:
/// the first round with `walls_first`, else the last.
template <class Real, class Act, class Walls>
struct ChainPasses {
  using Contacts = Iteration<Real, OverRelaxed<Act>>;
  static constexpr bool static_item_counts = true;
  static constexpr int passes = 3, rounds_per_pass = Colouring::colours + 1,
                       rounds = passes * rounds_per_pass;

  Contacts contacts;
  Walls walls;
  ChainView chains;
  const std::uint8_t* struck;   ///< by body: 0: slow, 1: fast, 2 and more: has had an impact in this substep
  const std::uint32_t* moving;  ///< 0: no body is fast or has had an impact
  bool walls_first;

  /// Colouring::colours: planes and boxes.
  SIM_HD int part(int round) const {
    const int place = round % rounds_per_pass;
    return walls_first ? (place == 0 ? +Colouring::colours : place - 1) : place;
  }
  SIM_HD std::int64_t items(int round) const {
    if (read_only(moving) == 0) return 0;
    const int now = part(round);
    return now < Colouring::colours || walls.count() > 0 ? read_only(chains.count + now) : 0;
  }
  SIM_HD void operator()(int round, int item) const {
    const int now = part(round);
    if (now == Colouring::colours) {
      const auto body = static_cast<int>(chains.bodies[item]);
      if (struck[body] > 0 && walls.is_near(body)) walls(body);
      return;
    }
    const std::uint32_t place =
        chains.places[read_only(contacts.contacts.begin + now) + static_cast<std::uint32_t>(item)];
    if (moves(place)) contacts(contacts.fetch(place));
  }
  /// Contacts of bodies that an impact has changed, and loaded contacts of fast bodies. Not those that close
  /// a gap: their impulse is no load, and too much of it throws bodies up.
  SIM_HD bool moves(std::uint32_t place) const {
    const Pair ids = contacts.contacts.ids[place];
    const std::uint8_t mark = max_of(struck[ids.a], struck[ids.b]);
    if (mark == 0 || contacts.contacts.sums[place].impact.is_closing()) return false;
    return mark > 1 || contacts.contacts.soft[place].impulse > 0;
  }
};

}  // namespace collidoscope

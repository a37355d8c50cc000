#pragma once
// Colours contacts so that no two of one colour share a body: each colour can then be solved in parallel, one
// colour after the other, with the same result in any order. The colouring is physics (it decides the order
// of impulses), so it is a pure function of the contacts: Jones & Plassmann (1993) on the line graph, with
// the priority hash(lower id, higher id) and ties by ids.
//
// In each round, a contact that has the highest priority among the uncoloured ones at both its bodies takes
// the lowest colour free at both. What is left after `rounds` rounds, or finds no free colour, is the
// mass-split set, solved last (mass_split.h).

#include <cstdint>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/step_control.h"

namespace collidoscope {

struct ColourView {
  const std::uint32_t* order;  ///< contact numbers, colour by colour, the split set last
  const std::uint32_t* begin;  ///< where colour c starts in `order`; c = Colouring::colours: the split set
  const std::uint32_t* count;  ///< how many contacts it has
};

/// For Executor::run_rounds: stage(contact) for all contacts of one colour before the next.
template <class Stage>
struct ColourByColour {
  ColourView view;
  Stage stage;
  SIM_HD std::int64_t items(int colour) const { return view.count[colour]; }
  SIM_HD void operator()(int colour, int item) const {
    stage(static_cast<int>(view.order[view.begin[colour] + static_cast<std::uint32_t>(item)]));
  }
};

class Colouring {
 public:
  static constexpr int colours = 32;
  static constexpr int rounds = 64;

  explicit Colouring(Executor& executor);
  void reserve(std::int64_t bodies, std::int64_t contact_capacity);
  /// Colours control->contacts contacts; sets control->split_contacts.
  void colour(const Pair* contacts, StepControl* control);
  ColourView view() const { return {order_.data(), begin_.data(), count_.data()}; }

 private:
  Executor& executor_;
  std::int64_t bodies_ = 0;
  Buffer<std::uint64_t>
      best_;  ///< 3 x bodies: highest priority seen at each body, of three rounds in rotation
  Buffer<std::uint32_t> used_;        ///< per body: bit c is set where colour c is taken
  Buffer<std::uint32_t> full_since_;  ///< per body: the round in which its last free colour went
  Buffer<std::uint32_t> pending_;     ///< per round: whether there are contacts to look at
  Buffer<std::uint8_t> colour_, sorted_colour_;
  Buffer<std::uint32_t> contact_, order_;
  Buffer<std::uint32_t> begin_, count_;
  Buffer<std::byte> temporary_;
};

}  // namespace collidoscope

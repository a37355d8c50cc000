#pragma once
// Colours contacts so that no two of one colour share a body: each colour can then be solved in parallel, one
// colour after the other, with the same result in any order. The colouring is physics (it decides the order
// of impulses), so it is a pure function of the contacts.
//
// In each round, an uncoloured contact proposes a colour that is free at both its bodies: by its hash and the
// round, one of the lowest half as many as the busier body has uncoloured contacts. It gets the colour where
// no other proposal has a higher priority at either body (Luby 1986, for each body and colour); the highest
// of all always does. So a body hands out many colours at once, where a matching a colour (Jones & Plassmann
// 1993, on the line graph) would take as many rounds as the busiest body has contacts: a pile of 50,000 needs
// 7 rounds instead of 33, for as many colours. What is left after `rounds` rounds, or finds no
// free colour, is the mass-split set, solved last.

#include <cstdint>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/solver/contact_degrees.h"

namespace collidoscope {

/// A body while its contacts are coloured.
struct alignas(16) ColouredBody {
  std::uint32_t used;       ///< bit c is set where colour c is taken
  std::uint32_t degree;     ///< contacts that it takes part in
  std::uint32_t proposals;  ///< where those of its contacts start
};

struct ColourView {
  const std::uint32_t* order;  ///< contact numbers, colour by colour, the split set last
  const std::uint32_t* begin;  ///< where colour c starts in `order`; c = Colouring::colours: the split set
  const std::uint32_t* count;  ///< how many contacts it has
  const std::uint8_t* colour;  ///< as `order`; `colours` or more: none
  const ColouredBody* bodies;  ///< what they used
};

/// For Executor::run_rounds: stage(contact) for all contacts of one colour before the next.
template <class Stage>
struct ColourByColour {
  ColourView view;
  Stage stage;
  static constexpr bool static_item_counts = true;
  SIM_HD std::int64_t items(int colour) const { return read_only(view.count + colour); }
  SIM_HD void operator()(int colour, int item) const {
    stage(static_cast<int>(view.order[read_only(view.begin + colour) + static_cast<std::uint32_t>(item)]));
  }
};

class Colouring {
 public:
  static constexpr int colours = 32;
  static constexpr int rounds = 24;

  /// `enabled` false: nothing is coloured, and all contacts are the mass-split set.
  explicit Colouring(Executor& executor, bool enabled = true);
  void reserve(std::int64_t bodies, std::int64_t contact_capacity);
  /// Colours control->contacts contacts; sets control->uncoloured_contacts. Those of bodies that are `asleep`
  /// (by body, or null) get no colour and stand behind all others in `order`.
  void colour(const Pair* contacts, StepControl* control, const std::uint8_t* asleep = nullptr);
  /// Of all contacts.
  const ContactDegrees& degrees() const { return degrees_; }
  ColourView view() const {
    return {order_.data(), begin_.data(), count_.data(), sorted_colour_.data(), coloured_.data()};
  }

 private:
  Executor& executor_;
  const bool enabled_;
  ContactDegrees degrees_;
  Buffer<std::uint64_t> proposals_;  ///< by body, then by colour
  Buffer<ColouredBody> coloured_;
  Buffer<std::uint32_t> pending_;  ///< per round: whether there are contacts to look at
  Buffer<std::uint8_t> colour_, sorted_colour_;
  Buffer<std::uint32_t> contact_, order_;
  Buffer<std::uint32_t> begin_, count_;
  Buffer<std::byte> temporary_;
};

}  // namespace collidoscope

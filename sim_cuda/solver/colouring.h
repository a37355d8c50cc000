#pragma once
// Graph colouring of contacts: no two contacts of a colour share a body. Colours are solved one after the
// other, the contacts of a colour in parallel, with the same result in any order. The colouring decides the
// order of impulses, so it is a pure function of the contacts.
//
// In each round, an uncoloured contact proposes one colour that is free at both its bodies. The candidates
// are its lowest free colours, half as many as the busier body has uncoloured contacts. A hash of the pair
// and the round selects one. A contact gets the colour if no other proposal for it has a higher priority at
// either body (Luby 1986, per body and colour). The highest priority of all always wins, so each round
// makes progress.
//
// A body can hand out many colours in a round. One matching per colour (Jones & Plassmann 1993, on the line
// graph) takes as many rounds as the busiest body has contacts. A pile of 50,000 needs 7 rounds instead of
// 33, with as many colours. Contacts without a colour after `rounds` rounds, or without a free colour, form
// the mass-split set, which is solved last.

#include <cstdint>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/solver/contact_degrees.h"

namespace collidoscope {

/// State of a body during colouring.
struct alignas(16) ColouredBody {
  std::uint32_t used;       ///< bit c: colour c is used at this body
  std::uint32_t degree;     ///< number of contacts
  std::uint32_t proposals;  ///< index of its first proposal slot
};

struct ColourView {
  const std::uint32_t* order;  ///< contact numbers, sorted by colour; the mass-split set is last
  const std::uint32_t* begin;  ///< start of colour c in `order`; c = Colouring::colours: mass-split set
  const std::uint32_t* count;  ///< number of contacts of colour c
  const std::uint8_t* colour;  ///< in the order of `order`; `colours` or more: uncoloured
  const ColouredBody* bodies;  ///< colours used at each body
};

/// For Executor::run_rounds: calls stage(contact) for all contacts of a colour before the next colour.
template <class Stage>
struct ColourByColour {
  ColourView view;
  Stage stage;
  static constexpr bool static_item_counts = true;
  static constexpr int most_threads =
      384;  // measured, H200: impacts of 300,000 bodies take 18 % less than with 1024
  SIM_HD std::int64_t items(int colour) const { return read_only(view.count + colour); }
  SIM_HD void operator()(int colour, int item) const {
    stage(static_cast<int>(view.order[read_only(view.begin + colour) + static_cast<std::uint32_t>(item)]));
  }
};

class Colouring {
 public:
  static constexpr int colours = 32;
  static constexpr int rounds = 24;

  /// `enabled` false: all contacts are in the mass-split set (solver `jacobi_split`).
  explicit Colouring(Executor& executor, bool enabled = true);
  void reserve(std::int64_t bodies, std::int64_t contact_capacity);
  /// Colours control->contacts contacts and sets control->uncoloured_contacts. Contacts of sleeping bodies
  /// (`asleep`, by body, or null) get no colour and come last in `order`.
  void colour(const Pair* contacts, StepControl* control, const std::uint8_t* asleep = nullptr);
  /// Contacts per body, of all contacts.
  const ContactDegrees& degrees() const { return degrees_; }
  ColourView view() const {
    return {order_.data(), begin_.data(), count_.data(), sorted_colour_.data(), coloured_.data()};
  }

 private:
  Executor& executor_;
  const bool enabled_;
  ContactDegrees degrees_;
  Buffer<std::uint64_t> proposals_;  ///< by body, then by colour slot
  Buffer<ColouredBody> coloured_;
  Buffer<std::uint32_t>
      pending_;  ///< per round, Pending::places flags: nonzero if uncoloured contacts remain
  Buffer<std::uint8_t> colour_, sorted_colour_;
  Buffer<std::uint32_t> contact_, order_;
  Buffer<std::uint32_t> begin_, count_;
  Buffer<std::byte> temporary_;
};

}  // namespace collidoscope

#pragma once
// Chain contacts: both bodies have few contacts, as in a column of single balls. Each of them carries most of
// the load, so an impulse at one end of a chain must pass through all its contacts. A pass over all contacts
// moves it by a few. In a pile, loads have many ways, and less depends on each contact. So chain contacts get
// more passes (chain_passes.h). Owned by the solver; listed for each contact list.

#include <cstdint>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/solver/colouring.h"
#include "sim_cuda/solver/contact_degrees.h"

namespace collidoscope {

struct ChainView {
  std::uint32_t* count;          ///< contacts of each colour, then bodies: Colouring::colours + 1 numbers
  std::uint32_t* places;         ///< of contacts; those of a colour begin at the start of the colour
  std::uint32_t* bodies;         ///< bodies with few contacts
  const std::uint32_t* degrees;  ///< contacts by body

  /// Most contacts of a body in a chain. Contacts that are only predicted count. In a pile of 5,000 that
  /// falls, a pass visits 1.4 % of the contacts; with 4, 4.6 %.
  static constexpr std::uint32_t most_contacts = 3;
  SIM_HD bool has_few_contacts(std::uint32_t body) const { return degrees[body] <= most_contacts; }
};

class ChainContacts {
 public:
  explicit ChainContacts(Executor& executor);
  void reserve(std::int64_t bodies, std::int64_t contact_capacity);
  /// Lists the chain contacts among those that have a colour, and their bodies. `ids`: bodies of a contact by
  /// place. `asleep`: by body, or null.
  void list(const Pair* ids, const Colouring& colouring, const StepControl* control,
            const std::uint8_t* asleep);
  ChainView view(const Colouring& colouring) const {
    return {count_.data(), places_.data(), listed_bodies_.data(), colouring.degrees().view().count};
  }

 private:
  Executor& executor_;
  Buffer<std::uint32_t> count_, places_, listed_bodies_;  ///< see ChainView
};

}  // namespace collidoscope

#pragma once
// Chain contacts: both bodies have few contacts, as in a column of single balls. Each of them carries most of
// the load, so an impulse at one end of a chain must pass through all its contacts. A pass over all contacts
// moves it by a few. In a pile, loads have many ways, and less depends on each contact. So chain contacts get
// more passes (chain_passes.h), where bodies move. Owned by the solver. All chain contacts are listed in each
// step, those that move in each substep.

#include <cstdint>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/solver/colouring.h"
#include "sim_cuda/solver/contact_degrees.h"
#include "sim_cuda/solver/contact_storage.h"
#include "sim_cuda/solver/contacts_by_body.h"

namespace collidoscope {

/// State of contacts and bodies after the impacts of a substep.
template <class Real>
struct MovingContacts {
  const Pair* ids;  ///< by place, as the next one
  const PackedContact<Real>* soft;
  ContactsByBodyView by_body;   ///< places of all contacts
  const std::uint8_t* struck;   ///< by body: 0: slow, 1: fast, 2 and more: has had an impact
  const std::uint32_t* moving;  ///< 0: no body is fast or has had an impact
  Real near_gap;                ///< m; fast contacts without a load and with larger gaps are not listed
};

/// Chain contacts that move, in a substep.
struct ChainView {
  std::uint32_t* count;   ///< contacts of each colour, then bodies: `counts` numbers
  std::uint32_t* places;  ///< of contacts; those of a colour begin at the start of the colour
  std::uint32_t* bodies;  ///< of these contacts

  /// They have the lowest colours: the other contacts of the two bodies have at most 4. If they all have
  /// theirs, the lowest free one remains as the only candidate (colouring.h).
  static constexpr int colours = 5, of_bodies = colours, counts = of_bodies + 1;
};

class ChainContacts {
 public:
  /// Most contacts of a body in a chain. Contacts that are only predicted count. With 4, a pass visits three
  /// times as many contacts of a pile that falls.
  static constexpr std::uint32_t most_contacts = 3;

  explicit ChainContacts(Executor& executor);
  void reserve(std::int64_t bodies, std::int64_t contact_capacity);
  /// Lists the chain contacts among those that have a colour, and their bodies. `ids`: bodies of a contact by
  /// place. `asleep`: by body, or null.
  void list(const Pair* ids, const Colouring& colouring, const StepControl* control,
            const std::uint8_t* asleep);
  /// Lists those that move: of bodies that an impact has changed, and of fast bodies those that have a load
  /// or may get one in this substep. Also lists their bodies. Precondition: the numbers of view() are 0.
  template <class Real>
  void list_moving(const MovingContacts<Real>& contacts, const Colouring& colouring);
  /// Null before reserve().
  ChainView view() const { return {count_.data(), places_.data(), bodies_.data()}; }

 private:
  Executor& executor_;
  Buffer<std::uint32_t> members_;  ///< of the step: places of contacts, and bodies plus `is_body`
  Buffer<std::uint32_t> member_count_;
  Buffer<std::uint32_t> count_, places_, bodies_;  ///< see ChainView
};

}  // namespace collidoscope

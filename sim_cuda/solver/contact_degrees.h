#pragma once
// Number of contacts per body in a contact set, and a segment for each body in a shared list. Owned by the
// class that lists or colours the contacts; recomputed for each contact list.

#include <cstdint>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/executor.h"

namespace collidoscope {

/// A subset of a contact list: contacts order[*begin] to order[*begin + *count - 1]. Without `order`:
/// contacts 0 to *count - 1.
struct ContactSet {
  const Pair* contacts;
  const std::uint32_t *order, *begin, *count;
  SIM_HD std::uint32_t number(int item) const {
    return order == nullptr ? static_cast<std::uint32_t>(item)
                            : order[*begin + static_cast<std::uint32_t>(item)];
  }
};

struct DegreeView {
  const std::uint32_t* count;  ///< per body
  const std::uint32_t* begin;  ///< per body, start of its segment; undefined if count is 0
};

class ContactDegrees {
 public:
  explicit ContactDegrees(Executor& executor);
  void reserve(std::int64_t bodies, std::int64_t contact_capacity);
  /// Counts the contacts of `set` per body. `stage`: name of the stage for timing.
  void count(const char* stage, const ContactSet& set);
  DegreeView view() const { return {count_.data(), begin_.data()}; }
  /// Number of bodies, or 0 if the set is empty; view() is undefined then.
  ItemCount bodies() const { return ItemCount(items_.data(), bodies_); }
  const std::uint32_t* body_items() const { return items_.data(); }  ///< bodies(), on the device

 private:
  Executor& executor_;
  std::int64_t bodies_ = 0, contact_capacity_ = 0;
  Buffer<std::uint32_t> items_;  ///< {bodies() value, allocated entries}
  Buffer<std::uint32_t> count_, begin_;
};

}  // namespace collidoscope

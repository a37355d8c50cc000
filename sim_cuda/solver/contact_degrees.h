#pragma once
// For each body, how many contacts of a set it takes part in, and room for as many entries in a list that all
// bodies share. Owned by whoever lists or colours contacts; made anew for each list of them.

#include <cstdint>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/executor.h"

namespace collidoscope {

/// Some contacts of a list: those numbered order[*begin], ..., order[*begin + *count - 1]; without an order,
/// 0 to *count - 1.
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
  const std::uint32_t* begin;  ///< per body, where its entries start; undefined where it has none
};

class ContactDegrees {
 public:
  explicit ContactDegrees(Executor& executor);
  void reserve(std::int64_t bodies, std::int64_t contact_capacity);
  /// As part of that stage.
  void count(const char* stage, const ContactSet& set);
  DegreeView view() const { return {count_.data(), begin_.data()}; }
  /// All bodies, or none where the set is empty; the view means nothing then.
  ItemCount bodies() const { return ItemCount(items_.data(), bodies_); }
  const std::uint32_t* body_items() const { return items_.data(); }  ///< the same, on the device

 private:
  Executor& executor_;
  std::int64_t bodies_ = 0, contact_capacity_ = 0;
  Buffer<std::uint32_t> items_;  ///< {bodies or 0, entries handed out}
  Buffer<std::uint32_t> count_, begin_;
};

}  // namespace collidoscope

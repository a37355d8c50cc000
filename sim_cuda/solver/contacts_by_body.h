#pragma once
// For each body, the contacts of a set that it takes part in, in increasing id of the other body: so a body
// can add up what they do to it, in an order that nothing changes. Owned by a solver; made anew for each list
// of contacts.

#include <cstdint>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/buffer.h"

namespace collidoscope {

struct ContactsByBodyView {
  const std::uint32_t* count;  ///< per body
  const std::uint32_t* begin;  ///< per body, where its contacts start in `entry`; undefined where it has none
  const std::uint32_t* entry;  ///< contact numbers
};

class ContactsByBody {
 public:
  explicit ContactsByBody(Executor& executor);
  void reserve(std::int64_t bodies, std::int64_t contact_capacity);
  /// Lists contacts order[*begin], ..., order[*begin + *count - 1], as part of that stage.
  void list(const char* stage, const Pair* contacts, const std::uint32_t* order, const std::uint32_t* begin,
            const std::uint32_t* count);
  ContactsByBodyView view() const { return {count_.data(), begin_.data(), entry_.data()}; }
  /// All bodies, or none where the set is empty; the view's counts mean nothing then.
  Count bodies() const { return Count(items_.data(), bodies_); }

 private:
  Executor& executor_;
  std::int64_t bodies_ = 0, contact_capacity_ = 0;
  Buffer<std::uint32_t> items_;  ///< {bodies or 0, entries handed out}
  Buffer<std::uint32_t> count_, filled_, begin_, entry_;
};

}  // namespace collidoscope

#pragma once
// This program's operator new: it counts what is taken and given back, and can be told to refuse. What the
// executor takes on the CPU comes from here too; what C libraries take does not. All threads share the
// counts.

#include <cstdint>

namespace collidoscope {

struct CountedNew {
  std::int64_t live_bytes = 0;   ///< taken and not given back
  std::int64_t peak_bytes = 0;   ///< the most of these since forget_peak()
  std::int64_t allocations = 0;  ///< asked for since the program began, refused ones among them
};
CountedNew counted_new();
/// The peak is what there is now.
void forget_peak();

enum class Refusal { once, from_then_on };

/// While it lives, the allocation after `granted` more is refused, or that and all that follow.
class RefusedNew {
 public:
  RefusedNew(std::int64_t granted, Refusal refusal);
  ~RefusedNew();
  RefusedNew(const RefusedNew&) = delete;
  RefusedNew& operator=(const RefusedNew&) = delete;

  /// Whether it came to a refusal.
  bool refused() const;
};

}  // namespace collidoscope

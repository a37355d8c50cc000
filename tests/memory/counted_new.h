#pragma once
// The operator new of the memory tests: it counts allocations and can make them fail. The executor's CPU
// buffers are included; allocations of C libraries are not. The counts are shared by all threads.

#include <cstdint>

namespace collidoscope {

struct CountedNew {
  std::int64_t live_bytes = 0;   ///< allocated and not freed
  std::int64_t peak_bytes = 0;   ///< largest live_bytes since forget_peak()
  std::int64_t allocations = 0;  ///< since the start of the program, including failed ones
};
CountedNew counted_new();
/// Sets the peak to the current live bytes.
void forget_peak();

enum class Refusal { once, from_then_on };

/// During its lifetime, the allocation after `granted` more fails, or that and all later ones.
class RefusedNew {
 public:
  RefusedNew(std::int64_t granted, Refusal refusal);
  ~RefusedNew();
  RefusedNew(const RefusedNew&) = delete;
  RefusedNew& operator=(const RefusedNew&) = delete;

  /// Whether an allocation failed.
  bool refused() const;
};

}  // namespace collidoscope

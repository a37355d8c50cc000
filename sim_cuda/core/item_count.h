#pragma once
// How many items a stage has. The number may be known on a GPU alone.

#include <cstdint>

#include "sim_cuda/core/host_device.h"

namespace collidoscope {

/// How many items a stage has: known to the host, or the value of a counter in the executor's memory. The
/// stage reads the counter when it starts, so that the host need not wait for it.
struct Count {
  std::int64_t bound = 0;                  ///< the number of items, or an upper bound of it
  const std::uint32_t* counter = nullptr;  ///< where the number stands; null: it is `bound`

  Count(std::int64_t items) : bound(items) {}  // NOLINT(google-explicit-constructor): a number is a Count
  Count(const std::uint32_t* where, std::int64_t at_most) : bound(at_most), counter(where) {}
  SIM_HD std::int64_t value() const {
    if (counter == nullptr) return bound;
    const auto items = static_cast<std::int64_t>(*counter);
    return items < bound ? items : bound;
  }
};

}  // namespace collidoscope

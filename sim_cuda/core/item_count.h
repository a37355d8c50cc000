#pragma once
// Number of items of a stage, which may be known on the GPU only.

#include <cstdint>

#include "sim_cuda/core/host_device.h"

namespace collidoscope {

/// Number of items of a stage: a host value, or a counter in the executor's memory. The stage reads the
/// counter when it starts, so that the host need not wait for it.
struct ItemCount {
  std::int64_t max = 0;  ///< number of items, or an upper bound of it
  /// Counter in the executor's memory; null: the number is `max`.
  const std::uint32_t* device_count = nullptr;

  ItemCount(std::int64_t items)
      : max(items) {}  // NOLINT(google-explicit-constructor): a number is an ItemCount
  ItemCount(const std::uint32_t* where, std::int64_t at_most) : max(at_most), device_count(where) {}
  SIM_HD std::int64_t value() const {
    if (device_count == nullptr) return max;
    const auto items = static_cast<std::int64_t>(*device_count);
    return items < max ? items : max;
  }
};

}  // namespace collidoscope

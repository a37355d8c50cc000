#pragma once
// Sorting a short run of numbers inside one item of a stage.

#include <cstdint>

#include "sim_cuda/core/host_device.h"

namespace collidoscope {

/// Sorts values[0 .. count) ascending: insertion for the usual handful, heap sort (O(n log n), in place) for
/// the hub of a thousand contacts.
SIM_HD inline void sort_segment(std::uint32_t* values, std::int64_t count) {
  if (count <= 24) {
    for (std::int64_t i = 1; i < count; ++i) {
      const std::uint32_t value = values[i];
      std::int64_t k = i;
      for (; k > 0 && values[k - 1] > value; --k) values[k] = values[k - 1];
      values[k] = value;
    }
    return;
  }
  const auto sift = [values](std::int64_t root, std::int64_t end) {
    const std::uint32_t value = values[root];
    for (;;) {
      std::int64_t child = 2 * root + 1;
      if (child >= end) break;
      if (child + 1 < end && values[child + 1] > values[child]) ++child;
      if (values[child] <= value) break;
      values[root] = values[child];
      root = child;
    }
    values[root] = value;
  };
  for (std::int64_t root = count / 2; root-- > 0;) sift(root, count);
  for (std::int64_t end = count; end-- > 1;) {
    const std::uint32_t largest = values[0];
    values[0] = values[end];
    values[end] = largest;
    sift(0, end);
  }
}

}  // namespace collidoscope

#pragma once
// The contacts of the run before, and where one of them stands: what it gave then is a start for what it
// gives now (warm starting by the ids of its bodies).

#include <cstdint>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/host_device.h"

namespace collidoscope {

/// Ordered by (a, b), in the executor's memory.
struct PreviousContacts {
  const Pair* contacts;
  const std::uint32_t* count;  ///< one
  const std::uint32_t* first;  ///< by body a; of no meaning where it has none

  /// Where a pair stands, or `no_pair`. Looks in steps that double from a's first contact on: most bodies
  /// have a few, and one may have thousands.
  SIM_HD std::uint32_t find(std::uint32_t a, std::uint32_t b) const {
    const std::uint32_t size = *count;
    std::uint32_t low = first[a], high = low;
    for (std::uint32_t stride = 1; high < size && contacts[high].precedes(a, b); stride *= 2) {
      low = high + 1;
      high = size - low > stride ? low + stride : size;
    }
    return find_pair(contacts, low, high < size ? high + 1 : size, a, b);
  }
  /// Whether contact k is the first of its body a: what `first` is made from.
  SIM_HD static bool is_first(const Pair* contacts, std::uint32_t k) {
    return k == 0 || contacts[k - 1].a != contacts[k].a;
  }
};

}  // namespace collidoscope

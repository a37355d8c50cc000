#pragma once
// Contacts of the previous run, with lookup by body pair. The impulses of a found contact are used for warm
// starting. A view; does not own memory.

#include <cstdint>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/host_device.h"

namespace collidoscope {

/// Sorted by (a, b), in the executor's memory.
struct PreviousContacts {
  const Pair* contacts;
  const std::uint32_t* count;  ///< one element
  const std::uint32_t* first;  ///< first contact of body a; undefined if a has none

  /// Index of a pair, or `no_pair`. Galloping search from a's first contact: most bodies have few contacts,
  /// some have thousands.
  SIM_HD std::uint32_t find(std::uint32_t a, std::uint32_t b) const {
    const std::uint32_t size = *count;
    std::uint32_t low = first[a], high = low;
    for (std::uint32_t stride = 1; high < size && contacts[high].precedes(a, b); stride *= 2) {
      low = high + 1;
      high = size - low > stride ? low + stride : size;
    }
    return find_pair(contacts, low, high < size ? high + 1 : size, a, b);
  }
  /// True if contact k is the first of its body a. Defines the entries of `first`.
  SIM_HD static bool is_first(const Pair* contacts, std::uint32_t k) {
    return k == 0 || contacts[k - 1].a != contacts[k].a;
  }
};

}  // namespace collidoscope

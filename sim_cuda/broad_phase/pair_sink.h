#pragma once
// Where a broad phase leaves the pairs that it finds: appended to one list in any order and counted per body,
// in a single traversal. pair_list.cpp then puts them in order, so the order of arrival is never seen.

#include <cstdint>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/executor.h"

namespace collidoscope {

struct PairSink {
  Pair* found;  ///< room for `capacity`
  std::uint64_t capacity;
  std::uint64_t* total;  ///< pairs found, those beyond the capacity too: what it takes is always known
  std::uint32_t* count;  ///< per body: pairs in which it is the smaller id

  /// Each overlapping pair once, in either order; x != y.
  SIM_HD void add(std::uint32_t x, std::uint32_t y) const {
    const Pair pair = x < y ? Pair{x, y} : Pair{y, x};
    const std::uint64_t place = atomic_next(total);
    if (place < capacity) found[place] = pair;
    atomic_add(&count[pair.a], 1);
  }
};

}  // namespace collidoscope

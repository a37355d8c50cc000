#include "sim_cuda/broad_phase/pair_list.h"

#include "sim_cuda/core/block.h"
#include "sim_cuda/core/scan.h"
#include "sim_cuda/core/segment_sort.h"

namespace collidoscope {

namespace {

/// Places the pairs of the bodies first .. last - 1. Scattered writes to a list larger than the cache cost a
/// memory sector each. Writes to a part that fits in the cache cost far less.
struct PlacePairs {
  const FoundPair* found;
  std::uint32_t first, last;
  const std::uint32_t* offset;
  std::uint32_t* second;
  std::uint64_t capacity;
  SIM_HD void operator()(int k) const {
    const auto [pair, rank] = found[k];
    if (pair.a < first || pair.a >= last) return;
    const std::uint64_t place = std::uint64_t{offset[pair.a]} + rank;
    if (place < capacity) second[place] = pair.b;  // offsets are invalid after an overflow
  }
};

/// Sorts the segment of each body. The item after the last body accepts the list, or reports the needed
/// capacity.
struct SortPairs {
  const std::uint32_t* offset;
  std::uint32_t* second;
  const std::uint64_t* total;
  std::uint64_t capacity;
  int bodies;
  StepControl* control;
  SIM_HD void operator()(int body) const {
    if (body == bodies) {
      control->pairs_needed = *total;
      if (*total > capacity) control->overflow = 1;
      control->pairs = control->overflow ? 0 : static_cast<std::uint32_t>(*total);
    } else if (*total <= capacity) {
      sort_segment(second + offset[body], offset[body + 1] - offset[body]);
    }
  }

  SIM_HD bool is_large(int body) const {
    return body < bodies && *total <= capacity && offset[body + 1] - offset[body] > large_list_size;
  }
#if defined(__CUDACC__)
  __device__ void process_by_block(int body) const {
    sort_segment_by_block(second + offset[body], offset[body + 1] - offset[body]);
  }
#endif
};

/// Number of parts of the bodies for PlacePairs. Each part takes about half of a large cache.
std::uint32_t placing_rounds(std::size_t list_bytes) {
  constexpr std::size_t part = 64 << 20;
  return static_cast<std::uint32_t>(list_bytes / part) + 1;
}

}  // namespace

PairList::PairList(Executor& executor)
    : executor_(executor),
      found_(executor, "pair count"),
      count_(executor, "pairs per body"),
      offset_(executor, "pair offsets"),
      second_(executor, "pairs"),
      temporary_(executor, "scan workspace") {}

void PairList::reserve(std::int64_t bodies, std::int64_t capacity) {
  bodies_ = bodies;
  count_.resize_discarding(static_cast<std::size_t>(bodies) + 3);
  offset_.resize_discarding(static_cast<std::size_t>(bodies) + 1);
  found_.resize_discarding(static_cast<std::size_t>(capacity));
  second_.resize_discarding(static_cast<std::size_t>(capacity));
  temporary_.resize_discarding(scan_temporary_bytes(executor_, bodies));
}

void PairList::find(BroadPhase& method, StepControl* control) {
  auto* total = reinterpret_cast<std::uint64_t*>(count_.data());
  std::uint32_t* count = count_.data() + 2;
  executor_.begin_stage("pairs");
  count_.fill_zero();
  method.find_pairs({found_.data(), found_.size(), total, count});
  exclusive_scan(executor_, "pairs", bodies_, count, offset_.data(), temporary_.data(), temporary_.bytes());
  const std::uint32_t rounds = placing_rounds(second_.bytes());
  const auto part = [&](std::uint32_t round) { return static_cast<std::uint32_t>(bodies_ * round / rounds); };
  for (std::uint32_t round = 0; round < rounds; ++round)
    executor_.run(
        "pairs",
        ItemCount(count_.data(), capacity()),  // lower half of the 64-bit total; equals the total if it fits
        PlacePairs{found_.data(), part(round), part(round + 1), offset_.data(), second_.data(),
                   second_.size()});
  executor_.run(
      "pairs", bodies_ + 1,
      SortPairs{offset_.data(), second_.data(), total, second_.size(), static_cast<int>(bodies_), control});
}

}  // namespace collidoscope

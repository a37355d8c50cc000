#include "sim_cuda/broad_phase/pair_list.h"

#include "sim_cuda/broad_phase/pair_sink.h"
#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/scan.h"
#include "sim_cuda/core/segment_sort.h"

namespace collidoscope {

namespace {

struct AcceptPairs {
  const std::uint64_t* total;
  std::uint64_t capacity;
  StepControl* control;
  SIM_HD void operator()(int) const {
    control->pairs_needed = *total;
    if (*total > capacity) control->overflow = 1;
    control->pairs = control->overflow ? 0 : static_cast<std::uint32_t>(*total);
  }
};

struct PlacePairs {
  const Pair* found;
  const std::uint64_t* offset;
  std::uint32_t *count, *second;
  SIM_HD void operator()(int k) const {
    const Pair pair = found[k];
    second[offset[pair.a] + atomic_add(&count[pair.a], ~std::uint32_t{0}) - 1] = pair.b;  // counts down to 0
  }
};

struct SortPairs {
  const std::uint64_t* offset;
  std::uint32_t* second;
  const StepControl* control;
  SIM_HD void operator()(int body) const {
    if (control->overflow) return;
    sort_segment(second + offset[body], static_cast<std::int64_t>(offset[body + 1] - offset[body]));
  }
};

}  // namespace

PairList::PairList(Executor& executor)
    : executor_(executor),
      found_(executor, "pairs found"),
      total_(executor, "number of pairs"),
      count_(executor, "pairs per body"),
      offset_(executor, "pair offsets"),
      second_(executor, "pairs"),
      temporary_(executor, "scan workspace") {}

void PairList::reserve(std::int64_t bodies, std::int64_t capacity) {
  bodies_ = bodies;
  count_.resize_discarding(static_cast<std::size_t>(bodies) + 1);
  offset_.resize_discarding(static_cast<std::size_t>(bodies) + 1);
  found_.resize_discarding(static_cast<std::size_t>(capacity));
  second_.resize_discarding(static_cast<std::size_t>(capacity));
  total_.resize_discarding(1);
  temporary_.resize_discarding(scan_temporary_bytes(executor_, bodies));
}

void PairList::find(BroadPhase& method, StepControl* control) {
  executor_.begin_stage("pairs");
  total_.fill_zero();
  count_.fill_zero();
  method.find_pairs({found_.data(), found_.size(), total_.data(), count_.data()});
  executor_.run("pairs", 1, AcceptPairs{total_.data(), found_.size(), control});
  exclusive_scan(executor_, "pairs", bodies_, count_.data(), offset_.data(), temporary_.data(),
                 temporary_.bytes());
  executor_.run("pairs", Count(&control->pairs, capacity()),
                PlacePairs{found_.data(), offset_.data(), count_.data(), second_.data()});
  executor_.run("pairs", bodies_, SortPairs{offset_.data(), second_.data(), control});
}

}  // namespace collidoscope

#include "sim_cuda/broad_phase/pair_list.h"

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
      count_(executor, "pairs per body"),
      offset_(executor, "pair offsets"),
      second_(executor, "pairs"),
      temporary_(executor, "scan workspace") {}

void PairList::reserve(std::int64_t bodies, std::int64_t capacity) {
  bodies_ = bodies;
  count_.resize_discarding(static_cast<std::size_t>(bodies) + 1);
  offset_.resize_discarding(static_cast<std::size_t>(bodies) + 1);
  second_.resize_discarding(static_cast<std::size_t>(capacity));
  temporary_.resize_discarding(scan_temporary_bytes(executor_, bodies));
  executor_.fill(count_.data(), 0, count_.bytes());
}

void PairList::find(BroadPhase& method, StepControl* control) {
  method.count_pairs(count_.data());
  exclusive_scan(executor_, "pairs", bodies_, count_.data(), offset_.data(), temporary_.data(),
                 temporary_.bytes());
  executor_.run("pairs", 1, AcceptPairs{offset_.data() + bodies_, second_.size(), control});
  method.write_pairs(offset_.data(), second_.data(), control);
  executor_.run("pairs", bodies_, SortPairs{offset_.data(), second_.data(), control});
}

}  // namespace collidoscope

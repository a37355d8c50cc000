#include "sim_cuda/run/run_lanes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace collidoscope {
namespace {

constexpr float no_value = std::numeric_limits<float>::quiet_NaN();
constexpr RunLanes::Range no_range{no_value, no_value};

// std::fmin and std::fmax ignore NaN.
void extend(RunLanes::Range& range, const RunLanes::Range& other) {
  range = {std::fmin(range.low, other.low), std::fmax(range.high, other.high)};
}

RunLanes::Ranges no_ranges() {
  RunLanes::Ranges ranges;
  ranges.fill(no_range);
  return ranges;
}

}  // namespace

void RunLanes::begin(std::int64_t first) {
  items_.clear();
  first_ = first;
  per_item_ = 1;
}

void RunLanes::add(std::int64_t state, const std::array<float, lanes>& values) {
  auto item = static_cast<std::size_t>((state - first_) / per_item_);
  while (item >= most_items) {
    for (std::size_t k = 0; k < items_.size(); k += 2) {
      Ranges merged = items_[k];
      for (std::size_t lane = 0; lane < lanes && k + 1 < items_.size(); ++lane)
        extend(merged[lane], items_[k + 1][lane]);
      items_[k / 2] = merged;
    }
    items_.resize((items_.size() + 1) / 2);
    per_item_ *= 2;
    item /= 2;
  }
  if (items_.size() <= item) items_.resize(item + 1, no_ranges());
  for (std::size_t lane = 0; lane < lanes; ++lane) extend(items_[item][lane], {values[lane], values[lane]});
}

void RunLanes::forget_after(std::int64_t state) {
  const std::int64_t states = state - first_ + 1;
  if (states <= 0) return items_.clear();
  const auto whole = static_cast<std::size_t>(states / per_item_);
  if (whole >= items_.size()) return;
  items_.resize(whole);
  // The values of a part of an item are not known.
  if (states % per_item_ != 0) items_.push_back(no_ranges());
}

RunLanes::Range RunLanes::total(Lane lane) const {
  Range all = no_range;
  for (const Ranges& item : items_) extend(all, item[lane]);
  return all;
}

}  // namespace collidoscope

#include "sim_cuda/tuning/launch_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace collidoscope {
namespace {

std::int64_t lanes(LaunchShape shape) { return std::int64_t{shape.blocks} * shape.threads; }

/// Distance of two shapes in the map, in doublings.
double distance(LaunchShape a, LaunchShape b) {
  return std::abs(std::log2(static_cast<double>(a.blocks) / b.blocks)) +
         std::abs(std::log2(static_cast<double>(a.threads) / b.threads));
}

constexpr double much_slower = 2;  // ratio to the fastest cell
constexpr std::size_t finalists = 4;

}  // namespace

LaunchSearch::LaunchSearch(const std::vector<int>& blocks, const std::vector<int>& threads, int thread_unit,
                           std::int64_t middle, int confirmation_pairs, int pairs_at_once)
    : thread_unit_(thread_unit),
      confirmation_pairs_(confirmation_pairs),
      pairs_at_once_(pairs_at_once),
      middle_(middle),
      blocks_(blocks) {
  for (const int b : blocks)
    for (const int t : threads) cells_.push_back({.shape = {b, t}, .reason = {}, .ratios = {}, .ms = {}});
  grid_size_ = cells_.size();
  std::vector<std::size_t> all(cells_.size());
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = k;
  std::ranges::stable_sort(all, {}, [&](std::size_t k) { return std::abs(from_middle(cells_[k].shape)); });
  queue(all, first_pairs);
}

double LaunchSearch::from_middle(LaunchShape shape) const {
  return std::log2(static_cast<double>(lanes(shape)) / static_cast<double>(middle_));
}

void LaunchSearch::queue(const std::vector<std::size_t>& cells, int pairs) {
  for (int done = 0; done < pairs; done += pairs_at_once_)
    for (const std::size_t cell : cells) tasks_.push_back({cell, std::min(pairs - done, pairs_at_once_)});
}

std::vector<std::size_t> LaunchSearch::fastest_first() const {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t k = 0; k < cells_.size(); ++k)
    if (cells_[k].state == LaunchCell::State::measured) order.emplace_back(cells_[k].estimate().ratio, k);
  std::ranges::sort(order);
  std::vector<std::size_t> result;
  for (const auto& [ratio, cell] : order) result.push_back(cell);
  return result;
}

/// Whether the next cell of the same T towards the middle is left out, or is much slower than the best one
/// and slower than its own next cell: farther cells are slower still.
bool LaunchSearch::is_left_out(std::size_t cell) {
  const LaunchShape shape = cells_[cell].shape;
  const std::ptrdiff_t own = std::ranges::find(blocks_, shape.blocks) - blocks_.begin();
  const std::ptrdiff_t step = from_middle(shape) < 0 ? 1 : -1;
  const auto inner_cell = [&](std::ptrdiff_t steps) -> const LaunchCell* {
    const std::ptrdiff_t at = own + steps * step;
    if (at < 0 || at >= std::ssize(blocks_)) return nullptr;
    const LaunchShape inner{blocks_[static_cast<std::size_t>(at)], shape.threads};
    return &*std::ranges::find(cells_, inner, &LaunchCell::shape);
  };
  const LaunchCell *const one = inner_cell(1), *const two = inner_cell(2);
  if (one == nullptr || std::abs(from_middle(one->shape)) > std::abs(from_middle(shape))) return false;
  bool left_out = one->state == LaunchCell::State::left_out;
  if (!left_out && !one->ratios.empty() && two != nullptr && !two->ratios.empty()) {
    double best = std::numeric_limits<double>::infinity();
    for (const LaunchCell& other : cells_)
      if (!other.ratios.empty()) best = std::min(best, std::ranges::max(other.ratios));
    // With two pairs, one of them may be an outlier: its cell must not hide others.
    const double fastest = std::ranges::min(one->ratios);
    left_out = fastest > much_slower * best && fastest > std::ranges::max(two->ratios);
  }
  if (left_out)
    exclude(cell, LaunchCell::State::left_out,
            std::to_string(one->shape.blocks) + " x " + std::to_string(one->shape.threads) +
                " is much slower than the best");
  return left_out;
}

std::optional<LaunchSearch::Task> LaunchSearch::next() {
  for (;;) {
    while (!tasks_.empty()) {
      const Task task = tasks_.front();
      tasks_.pop_front();
      const LaunchCell& cell = cells_[task.cell];
      if (cell.state != LaunchCell::State::waiting && cell.state != LaunchCell::State::measured) continue;
      if (phase_ == Phase::screening && is_left_out(task.cell)) continue;
      return task;
    }
    if (phase_ == Phase::ended) return std::nullopt;
    begin_next_phase();
  }
}

void LaunchSearch::begin_next_phase() {
  std::vector<std::size_t> order = fastest_first();
  if (order.empty()) {
    phase_ = Phase::ended;
    return;
  }
  switch (phase_) {
    case Phase::screening:
      phase_ = Phase::halving;
      survivors_ = order.size();
      [[fallthrough]];
    case Phase::halving:
      if (survivors_ > finalists) {
        survivors_ = std::max((survivors_ + 1) / 2, finalists);
        pairs_ = std::min(2 * pairs_, most_pairs);
        order.resize(std::min(survivors_, order.size()));
        return queue(order, pairs_);
      }
      phase_ = Phase::refining;
      return queue(shapes_around(order.front()), pairs_);
    case Phase::refining:
      // The finalists get as many pairs as the decision needs.
      if (pairs_ < most_pairs) {
        pairs_ = most_pairs;
        order.resize(std::min(finalists, order.size()));
        return queue(order, pairs_);
      }
      return hurry();
    case Phase::confirming:
      phase_ = Phase::ended;
      return;
    case Phase::ended:
      return;
  }
}

void LaunchSearch::hurry() {
  if (phase_ == Phase::confirming || phase_ == Phase::ended) return;
  tasks_.clear();
  chosen_ = chosen();
  phase_ = chosen_ ? Phase::confirming : Phase::ended;
  if (chosen_) tasks_.push_back({*chosen_, confirmation_pairs_});
}

/// Adds the shapes between the powers of two around a cell.
std::vector<std::size_t> LaunchSearch::shapes_around(std::size_t cell) {
  const LaunchShape best = cells_[cell].shape;
  std::vector<std::size_t> added;
  const auto add = [&](int blocks, int threads) {
    threads = threads / thread_unit_ * thread_unit_;
    const LaunchShape shape{blocks, threads};
    if (blocks < 1 || threads < 1 || threads > 1024) return;
    if (std::ranges::any_of(cells_, [&](const LaunchCell& known) { return known.shape == shape; })) return;
    added.push_back(cells_.size());
    cells_.push_back({.shape = shape, .reason = {}, .ratios = {}, .ms = {}});
  };
  add(best.blocks * 3 / 4, best.threads);
  add(best.blocks * 3 / 2, best.threads);
  add(best.blocks, best.threads * 3 / 4);
  add(best.blocks, best.threads * 3 / 2);
  return added;
}

void LaunchSearch::add(std::size_t cell, double ms, double reference_ms) {
  if (phase_ == Phase::confirming) return fresh_.push_back(ms / reference_ms);
  cells_[cell].state = LaunchCell::State::measured;
  cells_[cell].ratios.push_back(ms / reference_ms);
  cells_[cell].ms.push_back(ms);
}

void LaunchSearch::exclude(std::size_t cell, LaunchCell::State state, const std::string& reason) {
  cells_[cell].state = state;
  cells_[cell].reason = reason;
}

std::vector<std::size_t> LaunchSearch::plateau() const {
  const std::vector<std::size_t> order = fastest_first();
  if (order.empty()) return {};
  // Only cells with as many pairs as the best one were compared to the end.
  const RatioEstimate best = cells_[order.front()].estimate();
  std::vector<std::size_t> ties;
  for (const std::size_t cell : order) {
    const RatioEstimate one = cells_[cell].estimate();
    if (cell == order.front() || (2 * one.pairs >= best.pairs && one.low <= best.high)) ties.push_back(cell);
  }
  return ties;
}

std::optional<std::size_t> LaunchSearch::chosen() const {
  if (chosen_) return chosen_;
  const std::vector<std::size_t> ties = plateau();
  if (ties.empty()) return std::nullopt;
  // With few pairs, nothing can be told apart.
  if (!std::isfinite(cells_[ties.front()].estimate().high)) return ties.front();
  const auto spread = [&](std::size_t cell) {
    double sum = 0;
    for (const std::size_t other : ties) sum += distance(cells_[cell].shape, cells_[other].shape);
    return sum;
  };
  return *std::ranges::min_element(ties, {}, spread);
}

}  // namespace collidoscope

#include "sim_cuda/tuning/launch_tuner.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/wall_clock.h"

namespace collidoscope {
namespace {

/// Steps of a measurement: one timed as a whole, and one timed by stage.
constexpr int steps_of_pair = 2;

/// Share of the budget for the search; the rest is for the confirmations.
constexpr double search_share = 0.6;

template <class Number>
double median_of(std::vector<Number> samples) {
  if (samples.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  std::ranges::nth_element(samples, middle);
  return static_cast<double>(*middle);
}

std::vector<int> powers_of_two(int first, std::int64_t last) {
  std::vector<int> powers;
  for (std::int64_t power = first; power <= last; power *= 2) powers.push_back(static_cast<int>(power));
  return powers;
}

RunOptions with_shape(RunOptions options, LaunchShape shape) {
  options.shape = shape;
  return options;
}

}  // namespace

LaunchAxes launch_axes(int multiprocessors, std::int64_t bodies) {
  if (multiprocessors == 0)
    return {powers_of_two(1, std::clamp<std::int64_t>(bodies / 8, 1, 1024)), {1, 4, 16, 64}, 1, 64};
  LaunchAxes axes{{}, powers_of_two(32, 1024), 32, std::int64_t{512} * multiprocessors};
  for (int blocks = multiprocessors; blocks >= 8; blocks /= 2)
    axes.blocks.insert(axes.blocks.begin(), blocks);
  const std::int64_t most = std::clamp<std::int64_t>(bodies / 32, multiprocessors, 65536);
  for (std::int64_t blocks = 2 * multiprocessors; blocks <= most; blocks *= 2)
    axes.blocks.push_back(static_cast<int>(blocks));
  return axes;
}

LaunchTuner::LaunchTuner(World& world, double budget)
    : scene_(world.scene()),
      state_(world.state()),
      shape_(world.launch_shape()),
      budget_(budget),
      reference_(scene_, with_shape(world.options(), shape_), &state_),
      candidate_(scene_, with_shape(world.options(), shape_), &state_),
      search_([&] {
        reference_.step();  // records the launches
        int multiprocessors = 0;
        for (const StageTime& stage : reference_.latest_times().stages)
          multiprocessors = std::max(multiprocessors, stage.launch.multiprocessors);
        const LaunchAxes axes = launch_axes(multiprocessors, std::ssize(world.initial().radius));
        return LaunchSearch(axes.blocks, axes.threads, axes.thread_unit, axes.middle);
      }()),
      hash_([](World& w) { return w.state_hash(); }) {}

void LaunchTuner::advance(double milliseconds) {
  const Clock::time_point start = Clock::now();
  while (!done_) {
    const Clock::time_point before = Clock::now();
    ends_ =
        before + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(budget_ - spent_));
    if (spent_ > search_share * budget_) search_.hurry();
    if (!task_) task_ = search_.next();
    if (task_) {
      measure(*task_, 1e3 * seconds_since(before));
      task_.reset();
    } else {
      measure_stage_shapes();
      done_ = true;
    }
    spent_ += seconds_since(before);
    if (1e3 * seconds_since(start) >= milliseconds) return;
  }
}

void LaunchTuner::measure(const LaunchSearch::Task& task, double search_ms) {
  const Clock::time_point start = Clock::now();
  CellTimes times;
  try {
    candidate_.set_launch_shape(search_.cells()[task.cell].shape);
    const std::string difference = measure_pairs(
        task.pairs,
        [&](double ms, double reference_ms) {
          search_.add(task.cell, ms, reference_ms);
          reference_ms_.push_back(reference_ms);
          note_stages(reference_, 0);
          note_stages(candidate_, task.cell + 1);
        },
        times);
    if (!difference.empty()) search_.exclude(task.cell, LaunchCell::State::wrong, difference);
  } catch (const MachineError& error) {
    search_.exclude(task.cell, LaunchCell::State::infeasible, error.what());
  }
  if (cell_times_.size() <= task.cell) cell_times_.resize(task.cell + 1);
  CellTimes& sum = cell_times_[task.cell];
  sum.search += search_ms;
  sum.setup += 1e3 * seconds_since(start) - times.benchmark - times.check;
  sum.benchmark += times.benchmark;
  sum.check += times.check;
  sum.measured_at = std::chrono::system_clock::now();
}

std::string LaunchTuner::measure_pairs(int pairs, const std::function<void(double, double)>& note,
                                       CellTimes& times) {
  // The first steps after a change make graphs and fill caches.
  for (World* world : {&candidate_, &reference_}) {
    world->restore(state_);
    world->step(steps_of_pair);
  }
  const Clock::time_point first_pair = Clock::now();
  for (int pair = 0; pair < pairs && (pair == 0 || Clock::now() < ends_); ++pair) {
    const bool first = pair % 2 == 0;
    double reference_ms = first ? time_steps(reference_) : 0;
    const double ms = time_steps(candidate_);
    if (!first) reference_ms = time_steps(reference_);
    note(ms, reference_ms);
  }
  times.benchmark = 1e3 * seconds_since(first_pair);
  const Clock::time_point last_pair = Clock::now();
  const std::uint64_t expected = hash_(reference_), actual = hash_(candidate_);
  times.check = 1e3 * seconds_since(last_pair);
  if (actual == expected) return "";
  return fmt::format("state {}: hash {:016x}, expected {:016x}", candidate_.steps(), actual, expected);
}

StageShapes LaunchTuner::stage_shapes() const {
  StageShapes shapes;
  for (const Stage& stage : stages()) {
    if (!stage.obeys) continue;
    double best = stage.reference_ms;
    std::optional<LaunchShape> shape;
    for (std::size_t cell = 0; cell < stage.cell_ms.size(); ++cell) {
      const LaunchCell& one = search_.cells()[cell];
      // The median of two samples is too rough.
      if (one.state != LaunchCell::State::measured || std::ssize(one.ratios) <= LaunchSearch::first_pairs ||
          !(stage.cell_ms[cell] < best))
        continue;
      best = stage.cell_ms[cell];
      shape = one.shape;
    }
    if (shape) shapes.push_back({stage.name, *shape});
  }
  return shapes;
}

void LaunchTuner::measure_stage_shapes() {
  const StageShapes shapes = stage_shapes();
  if (shapes.empty()) return;
  candidate_.set_launch_shape(shape_);
  candidate_.set_stage_shapes(shapes);
  CellTimes times;
  stage_ratios_.clear();
  stage_difference_ = measure_pairs(
      LaunchSearch::fresh_pairs,
      [&](double ms, double reference_ms) { stage_ratios_.push_back(ms / reference_ms); }, times);
}

double LaunchTuner::time_steps(World& world) {
  const Clock::time_point start = Clock::now();
  world.step(steps_of_pair);
  return 1e3 * seconds_since(start) / steps_of_pair;
}

void LaunchTuner::note_stages(const World& world, std::size_t column) {
  for (const StageTime& stage : world.latest_times().stages) {
    auto found = std::ranges::find(stages_, stage.name, &StageSamples::name);
    if (found == stages_.end()) found = stages_.insert(found, {stage.name, false, {}, {}});
    found->obeys |= stage.launch.threads > 0 && !stage.library_launch;
    if (found->ms.size() <= column) {
      found->ms.resize(column + 1);
      found->launch.resize(column + 1);
    }
    found->launch[column] = stage.launch;
    found->ms[column].push_back(static_cast<float>(stage.last_ms));
  }
}

double LaunchTuner::reference_ms() const { return median_of(reference_ms_); }

std::vector<LaunchTuner::Stage> LaunchTuner::stages() const {
  std::vector<Stage> result;
  for (const StageSamples& samples : stages_) {
    Stage stage{samples.name, samples.obeys, samples.launch.front(), 0, {}, {}};
    stage.cell_ms.assign(search_.cells().size(), std::numeric_limits<double>::quiet_NaN());
    stage.occupancy.assign(search_.cells().size(), 0);
    for (std::size_t column = 0; column < samples.ms.size(); ++column) {
      (column == 0 ? stage.reference_ms : stage.cell_ms[column - 1]) = median_of(samples.ms[column]);
      if (column > 0) stage.occupancy[column - 1] = samples.launch[column].occupancy;
    }
    result.push_back(std::move(stage));
  }
  return result;
}

}  // namespace collidoscope

#include "sim_cuda/tuning/launch_tuner.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/wall_clock.h"

namespace collidoscope {
namespace {

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

/// To compare its stages: the median of two samples is too rough.
bool has_enough_pairs(const LaunchCell& cell) {
  return cell.state == LaunchCell::State::measured && std::ssize(cell.ratios) > LaunchSearch::first_pairs;
}

}  // namespace

LaunchAxes launch_axes(int multiprocessors, std::int64_t bodies) {
  if (multiprocessors == 0)
    return {powers_of_two(1, std::clamp<std::int64_t>(bodies / 8, 1, 1024)), {1, 4, 16, 64}, 1, 64, 4};
  LaunchAxes axes{{}, powers_of_two(32, 1024), 32, std::int64_t{512} * multiprocessors};
  for (int blocks = multiprocessors; blocks >= 8; blocks /= 2)
    axes.blocks.insert(axes.blocks.begin(), blocks);
  const std::int64_t most = std::clamp<std::int64_t>(bodies / 32, multiprocessors, 65536);
  for (std::int64_t blocks = 2 * multiprocessors; blocks <= most; blocks *= 2)
    axes.blocks.push_back(static_cast<int>(blocks));
  return axes;
}

LaunchTuner::LaunchTuner(World& world, double budget, int confirmation_pairs)
    : shape_(world.launch_shape()),
      budget_(budget),
      confirmation_pairs_(confirmation_pairs),
      pair_(world),
      search_([&] {
        pair_.reference().step();  // records the launches
        int multiprocessors = 0;
        for (const StageTime& stage : pair_.reference().latest_times().stages)
          multiprocessors = std::max(multiprocessors, stage.launch.multiprocessors);
        const LaunchAxes axes = launch_axes(multiprocessors, std::ssize(world.initial().radius));
        return LaunchSearch(axes.blocks, axes.threads, axes.thread_unit, axes.middle, confirmation_pairs,
                            axes.pairs_at_once);
      }()) {}

void LaunchTuner::advance(double milliseconds) {
  const Clock::time_point start = Clock::now();
  while (!done_) {
    const Clock::time_point before = Clock::now();
    ends_ =
        before + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(budget_ - spent_));
    if (!task_) {
      hurried_ = spent_ > search_share * budget_;
      if (hurried_) search_.hurry();
      task_ = search_.next();
    }
    if (task_) {
      tasks_.push_back(measure(*task_, 1e3 * seconds_since(before)));
      note(tasks_.back());
      task_.reset();
    } else {
      measure_stage_shapes();
      done_ = true;
    }
    spent_ += seconds_since(before);
    if (1e3 * seconds_since(start) >= milliseconds) return;
  }
}

TunerRecord::Task LaunchTuner::measure(const LaunchSearch::Task& task, double search_ms) {
  const Clock::time_point start = Clock::now();
  PairedSteps::Durations times;
  TunerRecord::Task finished{
      .cell = task.cell, .hurried = hurried_, .reason = {}, .pairs = {}, .times = {.search = search_ms}};
  try {
    pair_.candidate().set_launch_shape(search_.cells()[task.cell].shape);
    times = pair_.measure(task.pairs, ends_, [&](double ms, double reference_ms) {
      finished.pairs.push_back({ms, reference_ms, stage_pairs()});
      search_.add(task.cell, ms, reference_ms);
      note(task.cell, finished.pairs.back());
    });
    finished.reason = pair_.difference(times);
    if (!finished.reason.empty()) finished.state = LaunchCell::State::wrong;
  } catch (const MachineError& error) {
    finished.state = LaunchCell::State::infeasible;
    finished.reason = error.what();
  }
  if (finished.state != LaunchCell::State::measured)
    search_.exclude(task.cell, finished.state, finished.reason);
  finished.times.setup = 1e3 * seconds_since(start) - times.benchmark - times.check;
  finished.times.benchmark = times.benchmark;
  finished.times.check = times.check;
  finished.times.measured_at = std::chrono::system_clock::now();
  return finished;
}

void LaunchTuner::note(std::size_t cell, const TunerRecord::Pair& pair) {
  reference_ms_.push_back(pair.reference_ms);
  note_stages(cell, pair.stages);
}

void LaunchTuner::note(const TunerRecord::Task& task) {
  if (cell_times_.size() <= task.cell) cell_times_.resize(task.cell + 1);
  CellTimes& sum = cell_times_[task.cell];
  sum.search += task.times.search;
  sum.setup += task.times.setup;
  sum.benchmark += task.times.benchmark;
  sum.check += task.times.check;
  sum.measured_at = task.times.measured_at;
}

bool LaunchTuner::restore(const TunerRecord& record) {
  LaunchSearch search = search_;
  for (const TunerRecord::Task& task : record.tasks) {
    if (task.hurried) search.hurry();
    const std::optional<LaunchSearch::Task> next = search.next();
    if (!next || next->cell != task.cell || std::ssize(task.pairs) > next->pairs) return false;
    for (const TunerRecord::Pair& pair : task.pairs) search.add(task.cell, pair.ms, pair.reference_ms);
    if (task.state != LaunchCell::State::measured) search.exclude(task.cell, task.state, task.reason);
  }
  search_ = std::move(search);
  spent_ = record.spent;
  tasks_ = record.tasks;
  for (const TunerRecord::Task& task : tasks_) {
    for (const TunerRecord::Pair& pair : task.pairs) note(task.cell, pair);
    note(task);
  }
  return true;
}

StageShapes LaunchTuner::stage_shapes() const {
  StageShapes shapes;
  for (const Stage& stage : stages()) {
    if (!stage.obeys) continue;
    double best = stage.reference_ms;
    std::optional<LaunchShape> shape;
    for (std::size_t cell = 0; cell < stage.cell_ms.size(); ++cell) {
      const LaunchCell& one = search_.cells()[cell];
      if (!has_enough_pairs(one) || !(stage.cell_ms[cell] < best)) continue;
      best = stage.cell_ms[cell];
      shape = one.shape;
    }
    if (shape) shapes.push_back({stage.name, *shape});
  }
  return shapes;
}

bool LaunchTuner::compared_stages() const { return std::ranges::any_of(search_.cells(), has_enough_pairs); }

void LaunchTuner::measure_stage_shapes() {
  const StageShapes shapes = stage_shapes();
  if (shapes.empty()) return;
  pair_.candidate().set_launch_shape(shape_);
  pair_.candidate().set_stage_shapes(shapes);
  stage_ratios_.clear();
  for (StageSamples& stage : stages_) stage.fresh.clear();
  PairedSteps::Durations times =
      pair_.measure(confirmation_pairs_, ends_, [&](double ms, double reference_ms) {
        stage_ratios_.push_back(ms / reference_ms);
        note_stages(std::nullopt, stage_pairs());
      });
  stage_difference_ = pair_.difference(times);
}

std::vector<TunerRecord::StagePair> LaunchTuner::stage_pairs() const {
  std::vector<TunerRecord::StagePair> pairs;
  const std::vector<StageTime> of_cell = pair_.candidate().latest_times().stages;
  for (const StageTime& stage : pair_.reference().latest_times().stages) {
    const auto other = std::ranges::find(of_cell, stage.name, &StageTime::name);
    if (other != of_cell.end() && stage.last_ms > 0)
      pairs.push_back({stage.name, other->last_ms, stage.last_ms, other->launch.occupancy});
  }
  return pairs;
}

void LaunchTuner::note_stages(std::optional<std::size_t> cell,
                              const std::vector<TunerRecord::StagePair>& pairs) {
  const std::vector<StageTime> of_reference = pair_.reference().latest_times().stages;
  for (const TunerRecord::StagePair& pair : pairs) {
    auto found = std::ranges::find(stages_, pair.name, &StageSamples::name);
    if (found == stages_.end()) found = stages_.insert(found, {pair.name, false, {}, {}, {}, {}, {}});
    const auto stage = std::ranges::find(of_reference, pair.name, &StageTime::name);
    if (stage != of_reference.end()) {
      if (found->ms.empty()) found->launch = stage->launch;
      found->obeys |= stage->launch.threads > 0 && !stage->library_launch;
    }
    found->ms.push_back(static_cast<float>(pair.reference_ms));
    const double ratio = pair.ms / pair.reference_ms;
    if (!cell) {
      found->fresh.push_back(ratio);
      continue;
    }
    if (found->ratios.size() <= *cell) {
      found->ratios.resize(*cell + 1);
      found->occupancy.resize(*cell + 1, 0);
    }
    found->ratios[*cell].push_back(static_cast<float>(ratio));
    found->occupancy[*cell] = pair.occupancy;
  }
}

double LaunchTuner::reference_ms() const { return median_of(reference_ms_); }

std::vector<LaunchTuner::Stage> LaunchTuner::stages() const {
  std::vector<Stage> result;
  for (const StageSamples& samples : stages_) {
    Stage stage{samples.name,
                samples.obeys,
                samples.launch,
                median_of(samples.ms),
                {},
                samples.occupancy,
                estimate_ratio(samples.fresh)};
    stage.cell_ms.assign(search_.cells().size(), std::numeric_limits<double>::quiet_NaN());
    stage.occupancy.resize(search_.cells().size(), 0);
    for (std::size_t cell = 0; cell < samples.ratios.size(); ++cell)
      stage.cell_ms[cell] = stage.reference_ms * median_of(samples.ratios[cell]);
    result.push_back(std::move(stage));
  }
  return result;
}

}  // namespace collidoscope

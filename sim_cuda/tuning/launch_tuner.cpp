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
  PairedSteps::Durations times;
  try {
    pair_.candidate().set_launch_shape(search_.cells()[task.cell].shape);
    times = pair_.measure(task.pairs, ends_, [&](double ms, double reference_ms) {
      search_.add(task.cell, ms, reference_ms);
      reference_ms_.push_back(reference_ms);
      note_stages(task.cell);
    });
    if (const std::string difference = pair_.difference(times); !difference.empty())
      search_.exclude(task.cell, LaunchCell::State::wrong, difference);
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
        note_stages(std::nullopt);
      });
  stage_difference_ = pair_.difference(times);
}

void LaunchTuner::note_stages(std::optional<std::size_t> cell) {
  const std::vector<StageTime> of_cell = pair_.candidate().latest_times().stages;
  for (const StageTime& stage : pair_.reference().latest_times().stages) {
    const auto other = std::ranges::find(of_cell, stage.name, &StageTime::name);
    if (other == of_cell.end() || !(stage.last_ms > 0)) continue;
    auto found = std::ranges::find(stages_, stage.name, &StageSamples::name);
    if (found == stages_.end())
      found = stages_.insert(found, {stage.name, false, stage.launch, {}, {}, {}, {}});
    found->obeys |= stage.launch.threads > 0 && !stage.library_launch;
    found->ms.push_back(static_cast<float>(stage.last_ms));
    const double ratio = other->last_ms / stage.last_ms;
    if (!cell) {
      found->fresh.push_back(ratio);
      continue;
    }
    if (found->ratios.size() <= *cell) {
      found->ratios.resize(*cell + 1);
      found->occupancy.resize(*cell + 1, 0);
    }
    found->ratios[*cell].push_back(static_cast<float>(ratio));
    found->occupancy[*cell] = other->launch.occupancy;
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

#include "sim_cuda/run/broad_phase_times.h"

#include <algorithm>

#include "sim_cuda/core/elapsed.h"

namespace collidoscope {
namespace {

constexpr int warm_up = 3;

/// Time of each repeat, ms, after some warm-up runs.
std::vector<float> times_of(Executor& executor, int repeats, const std::function<void()>& work) {
  std::vector<float> times;
  for (int k = -warm_up; k < repeats; ++k) {
    const double ms = milliseconds_of(executor, work);
    if (k >= 0) times.push_back(static_cast<float>(ms));
  }
  return times;
}

}  // namespace

BroadPhaseTimes time_broad_phase(Executor& executor, Pipeline& pipeline, int repeats) {
  return time_broad_phase(
      executor, [&] { pipeline.find_pairs(); }, repeats);
}

BroadPhaseTimes time_broad_phase(Executor& executor, const std::function<void()>& find, int repeats) {
  BroadPhaseTimes times;
  {
    StepGraph plain(executor, false, find);
    times.whole = times_of(executor, repeats, [&] { plain.launch(); });
  }
  StepGraph timed(executor, true, find);
  StageClock& clock = executor.clock();
  for (int k = -warm_up; k < repeats; ++k) {
    timed.launch();
    executor.synchronize();
    timed.collect();
    if (k >= 0)
      for (const StageTime& stage : clock.step_in_progress()) {
        auto known = std::ranges::find(times.stages, stage.name, &BroadPhaseTimes::Stage::name);
        if (known == times.stages.end())
          known =
              times.stages.insert(times.stages.end(), {stage.name, {}, stage.launches, stage.library_launch});
        known->ms.push_back(static_cast<float>(stage.last_ms));
      }
    clock.discard_step();
  }
  return times;
}

std::vector<float> time_tree_queries(Executor& executor, const TreeView& tree, BvhStatistics& statistics,
                                     int repeats) {
  return times_of(executor, repeats, [&] { statistics.enqueue_queries(tree); });
}

}  // namespace collidoscope

#pragma once
// Times a broad phase on the current state, which stays unchanged.

#include <functional>
#include <vector>

#include "sim_cuda/broad_phase/bvh_cache.h"
#include "sim_cuda/core/stage_times.h"
#include "sim_cuda/run/pipeline.h"

namespace collidoscope {

/// Finds the pairs `repeats` times from positions to the sorted list: without timing of stages, then with
/// it. Precondition: the lists have sufficient capacity, as after a detection.
BroadPhaseTimes time_broad_phase(Executor& executor, Pipeline& pipeline, int repeats);
/// The same with `find`, which enqueues the work.
BroadPhaseTimes time_broad_phase(Executor& executor, const std::function<void()>& find, int repeats);

/// Times the same query of every body in the tree of any method, `repeats` times, in ms.
std::vector<float> time_tree_queries(Executor& executor, const TreeView& tree, BvhStatistics& statistics,
                                     int repeats);

}  // namespace collidoscope

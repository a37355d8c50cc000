#pragma once
// How long a broad phase takes by itself, on the state at hand, which stays as it is.

#include <vector>

#include "sim_cuda/broad_phase/bvh_cache.h"
#include "sim_cuda/core/stage_times.h"
#include "sim_cuda/run/pipeline.h"

namespace collidoscope {

/// Finds the pairs `repeats` times, from positions to the ordered list, plain and then with a time taken
/// after each stage. The lists must be long enough: after a detection.
BroadPhaseTimes time_broad_phase(Executor& executor, Pipeline& pipeline, int repeats);

/// One and the same query for whatever method's tree, of every body; `repeats` times, in ms.
std::vector<float> time_tree_queries(Executor& executor, const TreeView& tree, BvhStatistics& statistics,
                                     int repeats);

}  // namespace collidoscope

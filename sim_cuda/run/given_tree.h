#pragma once
// Measures a tree of a foreign program as those of our own methods are measured.

#include "sim_cuda/broad_phase/tree_quality.h"
#include "sim_cuda/core/executor_options.h"
#include "sim_cuda/import/tree_file.h"

namespace collidoscope {

/// All members except `own` and `bytes`, which are 0: the tree's own layout and traversal are not known.
TreeQuality quality_of(const GivenTree& tree, const ExecutorOptions& options);

}  // namespace collidoscope

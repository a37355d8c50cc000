#pragma once
// Measures a tree of a foreign program as those of our own methods are measured.

#include <memory>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/tree_quality.h"
#include "sim_cuda/core/executor_options.h"
#include "sim_cuda/import/tree_file.h"

namespace collidoscope {

/// A broad phase that has only this tree; find_pairs() finds nothing.
std::unique_ptr<BroadPhase> make_given_tree(Executor& executor, std::shared_ptr<const GivenTree> tree);

/// All members except `own` and `bytes`, which are 0: the tree's own layout and traversal are not known.
TreeQuality quality_of(const GivenTree& tree, const ExecutorOptions& options);

}  // namespace collidoscope

#pragma once
// Names and static properties of the broad phases. The properties are available without creating a broad
// phase.

#include <string>
#include <string_view>
#include <vector>

#include "sim_cuda/core/executor_options.h"

struct collidoscope_broad_phase;

namespace collidoscope {

struct BroadPhaseMethod {
  const char* name;
  std::string_view what;       ///< description; Markdown, as the next two
  std::string_view traversal;  ///< how a query traverses the tree
  std::string_view weakness = {};
  bool morton = false;        ///< sorts by Morton keys
  bool cpu_only = false;      ///< has no GPU implementation
  bool gpu_only = false;      ///< plug-ins only: has no CPU implementation
  bool needs_bullet = false;  ///< only builds with Bullet have it
  /// Cost of one comparison on one CPU core (Xeon at 2.x GHz), in ns. 0: the method does not compare all
  /// pairs.
  double ns_of_comparison = 0;
  const collidoscope_broad_phase* plugin = nullptr;  ///< functions of the library; null: built in
  std::string_view file = {};                        ///< of a plug-in: the full path of the library
  /// Of a plug-in: its validation found wrong pairs. All its pairs are compared then.
  bool has_wrong_pairs = false;
  bool is_replaced = false;  ///< a newer version of the library is loaded
};

/// The first entry is the default.
inline constexpr BroadPhaseMethod broad_phase_methods[] = {
    {.name = "lbvh_ropes",
     .what = "default. Linear BVH: Karras's order (2012), built in one bottom-up launch (Apetrei 2014), with "
             "ropes, i.e. escape indices (Prokopenko and Lebrun-Grandié 2024)",
     .traversal = "half, ropes",
     .morton = true},
    {.name = "bvh_bottom_up",
     .what = "the paper's BVH: Morton order, every two neighbours merged, level by level",
     .traversal = "half, stack",
     .weakness = "boxes that span jumps of the Morton curve: twice as many node visits",
     .morton = true},
    {.name = "bvh_input_order",
     .what = "the same without sorting (the paper's Figure 6): shows the effect of spatial sorting",
     .traversal = "half, stack",
     .weakness = "nearly N² tests"},
    {.name = "bvh_recursive",
     .what = "`bvh_bottom_up` with a recursive query",
     .traversal = "half, recursion",
     .weakness = "needs a call stack; the paper expects one fifth of the speed",
     .morton = true},
    {.name = "lbvh_top_down",
     .what = "Lauterbach et al. 2009, the paper's Table 3: splits from the root, with a work queue",
     .traversal = "half, stack",
     .weakness = "the build synchronises at each level, and few levels use the whole device",
     .morton = true},
    {.name = "refit",
     .what = "keeps the linear BVH of an earlier step with new boxes; rebuilds when the area of inner boxes "
             "has grown by a quarter. The decision is made on the device",
     .traversal = "half, ropes",
     .weakness = "the step after a large motion; a refit takes as long as a build (longer on a GPU)",
     .morton = true},
    {.name = "ploc",
     .what = "merges nearest neighbours among 16 in Morton order, round by round, after PLOC++ (Benthin et "
             "al. 2022) and H-PLOC (2024). A round that merges too few merges pairwise",
     .traversal = "half, ropes",
     .weakness = "the build: five launches per round, and each round leaves four fifths of the clusters",
     .morton = true},
    {.name = "kd_tree",
     .what = "object medians along the longest axis, from three sorted lists, each level by a scan; two "
             "planes per node, as in a bounding interval hierarchy (Wächter and Keller 2006)",
     .traversal = "half, stack",
     .weakness = "each level moves all bodies; a plane culls fewer bodies than a box"},
    {.name = "bsp",
     .what = "planes of any direction: the median along the principal axis of the centres, level by level; "
             "two planes per node",
     .traversal = "half, stack",
     .weakness = "one sort per level; an oblique plane culls fewer bodies and needs six multiplications"},
    {.name = "bullet_dbvt",
     .what = "Bullet's incremental AABB tree (the paper's section 3.2.3): boxes with a margin; a body that "
             "leaves its box is re-inserted. Needs `libbullet-dev` at build time",
     .traversal = "two subtrees against each other",
     .weakness = "CPU only, one thread; its memory is not counted in `bytes`; coincident bodies degenerate "
                 "the tree to a list",
     .cpu_only = true,
     .needs_bullet = true},
    {.name = "brute_force",
     .what = "the paper's method: all pairs are numbered and distributed over the threads",
     .traversal = "none",
     .weakness = "N² tests",
     .ns_of_comparison = 3},
    {.name = "brute_force_tiled",
     .what = "the same tests from shared memory (CPU: first-level cache, SIMD)",
     .traversal = "none",
     .weakness = "N² tests",
     .ns_of_comparison = 1},
    {.name = "uniform_grid",
     .what = "cells of one size, from the largest body",
     .traversal = "rows of cells",
     .weakness = "mixed sizes: the largest body determines the size of all cells"},
    {.name = "hierarchical_grid",
     .what = "one grid for each common size; a query reads its own grid and all coarser ones",
     .traversal = "rows of cells",
     .weakness = "many sizes: each body queries the grids of all larger sizes"},
};

/// Whether this build has the method.
bool is_built(const BroadPhaseMethod& method);

/// Adds the method of a plug-in (sim_cuda/plugin/), until the process ends. All that it points to must stay
/// valid. It replaces one of the same file. Throws InputError if there is another method of its name. Can be
/// called from any thread.
void add_broad_phase(const BroadPhaseMethod& method);

/// Names of the broad phases that `--broad-phase` accepts, the default first, those of plug-ins last.
std::vector<std::string> broad_phase_names();
/// Names supported by the device that `kind` resolves to. bullet_dbvt needs the CPU.
std::vector<std::string> broad_phase_names(ExecutorKind kind);

/// Names supported by GPUs, or by CPUs.
std::vector<std::string> broad_phase_names_on(bool on_gpu);

/// The method of that name in this build, or null.
const BroadPhaseMethod* find_broad_phase(const std::string& name);
/// True if the method sorts by Morton keys. The key length then affects the quality of its tree.
bool has_morton_keys(const std::string& name);
/// Whether it is the method of a loaded plug-in.
bool is_plugin(const std::string& name);
/// A line for each loaded plug-in, such as "mine: plug-in /home/me/libmine.so, pairs not compared". Reports
/// of measurements contain it.
std::vector<std::string> plugin_notes(PairComparison comparison);

}  // namespace collidoscope

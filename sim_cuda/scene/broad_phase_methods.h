#pragma once
// Names and static properties of the broad phases. The properties are available without creating a broad
// phase.

#include <string>
#include <vector>

#include "sim_cuda/core/executor_options.h"

namespace collidoscope {

struct BroadPhaseMethod {
  const char* name;
  bool morton = false;    ///< sorts by Morton keys
  bool cpu_only = false;  ///< has no GPU implementation
  /// Cost of one comparison on one CPU core (Xeon at 2.x GHz), in ns. 0: the method does not compare all
  /// pairs.
  double ns_of_comparison = 0;
};

/// The first entry is the default.
inline constexpr BroadPhaseMethod broad_phase_methods[] = {
    {"lbvh_ropes", true},     // linear BVH, stackless traversal along ropes
    {"bvh_bottom_up", true},  // the paper's tree, built over the Morton order
    {"bvh_input_order"},      // the paper's tree, built over the input order (the paper's Figure 6)
    {"bvh_recursive", true},  // the paper's tree, recursive query instead of a stack
    {"lbvh_top_down", true},  // linear BVH, built top-down from a work queue
    {"refit", true},          // linear BVH, refitted each step and rebuilt when its quality degrades
    {"ploc", true},           // PLOC: merges nearest neighbours; traversal along ropes
    {"kd_tree"},              // median splits along the longest axis
    {"bsp"},                  // median splits along arbitrary directions
#if SIM_BULLET
    {"bullet_dbvt", false, true},  // Bullet's dynamic tree, kept between steps; the paper's 3.2.3
#endif
    {"brute_force", false, false, 3},        // the paper's naive method
    {"brute_force_tiled", false, false, 1},  // all pairs, tiled in shared memory
    {"uniform_grid"},                        // cell size from the largest body
    {"hierarchical_grid"},                   // one grid per size class of bodies
};

/// Names accepted by `--broad-phase`. The first is the default.
std::vector<std::string> broad_phase_names();
/// Names supported by the device that `kind` resolves to. bullet_dbvt needs the CPU.
std::vector<std::string> broad_phase_names(ExecutorKind kind);

/// Finds a method by name. Null if there is no such method.
const BroadPhaseMethod* find_broad_phase(const std::string& name);
/// True if the method sorts by Morton keys. The key length then affects the quality of its tree.
bool has_morton_keys(const std::string& name);

}  // namespace collidoscope

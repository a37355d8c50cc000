#pragma once
// The names of the broad phases, and what of each is known without making one. Plain data.

#include <string>
#include <vector>

#include "sim_cuda/core/executor_options.h"

namespace collidoscope {

struct BroadPhaseMethod {
  const char* name;
  bool morton = false;    ///< begins with Morton keys
  bool cpu_only = false;  ///< no form of it runs on a GPU
  /// Of a method that compares all bodies: what one core of a CPU takes for a comparison, ns (Xeon at 2.x
  /// GHz).
  double ns_of_comparison = 0;
};

/// The default first.
inline constexpr BroadPhaseMethod broad_phase_methods[] = {
    {"lbvh_ropes", true},     // a linear BVH, walked along its ropes
    {"bvh_bottom_up", true},  // the paper's tree, over Morton order
    {"bvh_input_order"},      // the same, not clustered: the paper's Figure 6
    {"bvh_recursive", true},  // the paper's tree, its query by calls in place of a stack
    {"lbvh_top_down", true},  // a linear BVH from a work queue
    {"refit", true},          // the linear BVH kept from step to step, until it decays
    {"ploc", true},           // nearest neighbours merged, along its ropes
    {"kd_tree"},              // medians along the longest axis
    {"bsp"},                  // medians along any direction
#if SIM_BULLET
    {"bullet_dbvt", false, true},  // Bullet's own, from step to step; the paper's 3.2.3
#endif
    {"brute_force", false, false, 3},        // the paper's naive approach
    {"brute_force_tiled", false, false, 1},  // the same from shared memory
    {"uniform_grid"},                        // cells by the largest body
    {"hierarchical_grid"},                   // cells for each size of bodies
};

/// Names of the broad phases that `--broad-phase` accepts, the default first.
std::vector<std::string> broad_phase_names();
/// Of these, those that run on what `kind` comes to here: bullet_dbvt needs the CPU.
std::vector<std::string> broad_phase_names(ExecutorKind kind);

/// The method of that name, or null.
const BroadPhaseMethod* find_broad_phase(const std::string& name);
/// Whether its order is that of Morton keys, whose length then decides how good its tree is.
bool has_morton_keys(const std::string& name);

}  // namespace collidoscope

#include "sim_cuda/broad_phase/broad_phase.h"

#include <algorithm>
#include <iterator>

#include "sim_cuda/core/error.h"
#include "sim_cuda/world.h"

namespace collidoscope {

namespace {
struct Method {
  const char* name;
  std::unique_ptr<BroadPhase> (*make)(Executor&);
  bool morton = false;  ///< begins with Morton keys
  bool cpu_only = false;
};
constexpr Method methods[] = {
    {"lbvh_ropes", make_lbvh_ropes, true},        // a linear BVH, walked along its ropes
    {"bvh_bottom_up", make_bvh_bottom_up, true},  // the paper's tree, over Morton order
    {"bvh_input_order", make_bvh_input_order},    // the same, not clustered: the paper's Figure 6
    {"bvh_recursive", make_bvh_recursive, true},  // the paper's tree, its query by calls in place of a stack
    {"lbvh_top_down", make_lbvh_top_down, true},  // a linear BVH from a work queue
    {"refit", make_refit, true},                  // the linear BVH kept from step to step, until it decays
    {"ploc", make_ploc, true},                    // nearest neighbours merged, along its ropes
    {"kd_tree", make_kd_tree},                    // medians along the longest axis
    {"bsp", make_bsp},                            // medians along any direction
#if SIM_BULLET
    {"bullet_dbvt", make_bullet_dbvt, false, true},  // Bullet's own, from step to step; the paper's 3.2.3
#endif
    {"brute_force", make_brute_force},              // the paper's naive approach
    {"brute_force_tiled", make_brute_force_tiled},  // the same from shared memory
    {"uniform_grid", make_uniform_grid},            // cells by the largest body
    {"hierarchical_grid", make_hierarchical_grid},  // cells for each size of bodies
};
}  // namespace

std::vector<std::string> broad_phase_names() {
  std::vector<std::string> names;
  for (const Method& m : methods) names.emplace_back(m.name);
  return names;
}

std::vector<std::string> broad_phase_names(ExecutorKind kind) {
  const bool on_gpu = kind != ExecutorKind::cpu && cuda_available();
  std::vector<std::string> names;
  for (const Method& m : methods)
    if (!(m.cpu_only && on_gpu)) names.emplace_back(m.name);
  return names;
}

bool has_morton_keys(const std::string& name) {
  const auto* method = std::ranges::find(methods, name, &Method::name);
  return method != std::end(methods) && method->morton;
}

std::unique_ptr<BroadPhase> make_broad_phase(const std::string& name, Executor& executor) {
  std::string known;
  for (const Method& m : methods) {
    if (name == m.name) {
      if (m.cpu_only && executor.on_device())
        throw MachineError("--broad-phase " + name + " runs on the CPU alone: --executor cpu");
      return m.make(executor);
    }
    known += (known.empty() ? "" : ", ") + std::string(m.name);
  }
  throw InputError("--broad-phase: '" + name + "' is unknown; one of " + known);
}

}  // namespace collidoscope

#include "sim_cuda/broad_phase/broad_phase.h"

#include <iterator>
#include <string_view>

#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/broad_phase_methods.h"

namespace collidoscope {

namespace {
struct Factory {
  std::string_view name;
  std::unique_ptr<BroadPhase> (*make)(Executor&);
};
constexpr Factory factories[] = {
    {"lbvh_ropes", make_lbvh_ropes},
    {"bvh_bottom_up", make_bvh_bottom_up},
    {"bvh_input_order", make_bvh_input_order},
    {"bvh_recursive", make_bvh_recursive},
    {"lbvh_top_down", make_lbvh_top_down},
    {"refit", make_refit},
    {"ploc", make_ploc},
    {"kd_tree", make_kd_tree},
    {"bsp", make_bsp},
#if SIM_BULLET
    {"bullet_dbvt", make_bullet_dbvt},
#else
    {"bullet_dbvt", nullptr},
#endif
    {"brute_force", make_brute_force},
    {"brute_force_tiled", make_brute_force_tiled},
    {"uniform_grid", make_uniform_grid},
    {"hierarchical_grid", make_hierarchical_grid},
};

constexpr bool each_has_its_factory() {
  if (std::size(factories) != std::size(broad_phase_methods)) return false;
  for (std::size_t k = 0; k < std::size(factories); ++k)
    if (factories[k].name != broad_phase_methods[k].name) return false;
  return true;
}
static_assert(each_has_its_factory(),
              "the factories must match the names of broad_phase_methods.h, in the same order");
}  // namespace

std::vector<std::string> broad_phase_names(ExecutorKind kind) {
  const bool on_gpu = kind != ExecutorKind::cpu && cuda_available();
  std::vector<std::string> names;
  for (const BroadPhaseMethod& method : broad_phase_methods)
    if (is_built(method) && !(method.cpu_only && on_gpu)) names.emplace_back(method.name);
  return names;
}

std::unique_ptr<BroadPhase> make_broad_phase(const std::string& name, Executor& executor) {
  std::string known;
  for (std::size_t k = 0; k < std::size(factories); ++k) {
    if (factories[k].make == nullptr) continue;
    if (name == factories[k].name) {
      if (broad_phase_methods[k].cpu_only && executor.on_device())
        throw MachineError("broad phase " + name + " runs only on the CPU: set the executor to cpu");
      return factories[k].make(executor);
    }
    known += (known.empty() ? "" : ", ") + std::string(factories[k].name);
  }
  throw InputError("unknown broad phase '" + name + "'; expected one of " + known);
}

}  // namespace collidoscope

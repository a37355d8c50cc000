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
  return broad_phase_names_on(kind != ExecutorKind::cpu && cuda_available());
}

std::unique_ptr<BroadPhase> make_broad_phase(const std::string& name, Executor& executor) {
  const BroadPhaseMethod* method = find_broad_phase(name);
  if (method == nullptr) {
    std::string known;
    for (const std::string& each : broad_phase_names()) known += (known.empty() ? "" : ", ") + each;
    throw InputError("unknown broad phase '" + name + "'; expected one of " + known);
  }
  if (method->cpu_only && executor.on_device())
    throw MachineError("broad phase " + name + " runs only on the CPU: set the executor to cpu");
  if (method->gpu_only && !executor.on_device())
    throw MachineError("broad phase " + name + " runs only on a CUDA device: set the executor to cuda");
  if (method->plugin != nullptr) return make_plugin(executor, *method);
  return factories[method - std::begin(broad_phase_methods)].make(executor);
}

}  // namespace collidoscope

#include "sim_cuda/scene/broad_phase_methods.h"

#include <algorithm>
#include <iterator>

namespace collidoscope {

bool is_built(const BroadPhaseMethod& method) {
#if SIM_BULLET
  constexpr bool has_bullet = true;
#else
  constexpr bool has_bullet = false;
#endif
  return has_bullet || !method.needs_bullet;
}

std::vector<std::string> broad_phase_names() {
  std::vector<std::string> names;
  for (const BroadPhaseMethod& method : broad_phase_methods)
    if (is_built(method)) names.emplace_back(method.name);
  return names;
}

const BroadPhaseMethod* find_broad_phase(const std::string& name) {
  const auto* method = std::ranges::find(broad_phase_methods, name, &BroadPhaseMethod::name);
  return method != std::end(broad_phase_methods) && is_built(*method) ? method : nullptr;
}

bool has_morton_keys(const std::string& name) {
  const BroadPhaseMethod* method = find_broad_phase(name);
  return method != nullptr && method->morton;
}

}  // namespace collidoscope

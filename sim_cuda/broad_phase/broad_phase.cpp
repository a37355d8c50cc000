#include "sim_cuda/broad_phase/broad_phase.h"

#include "sim_cuda/core/error.h"
#include "sim_cuda/world.h"

namespace collidoscope {

namespace {
struct Method {
  const char* name;
  std::unique_ptr<BroadPhase> (*make)(Executor&);
};
constexpr Method methods[] = {
    {"bvh_bottom_up", make_bvh_bottom_up},
    {"brute_force", make_brute_force},
    {"lbvh_ropes", make_lbvh_ropes},
};
}  // namespace

std::vector<std::string> broad_phase_names() {
  std::vector<std::string> names;
  for (const Method& m : methods) names.emplace_back(m.name);
  return names;
}

std::unique_ptr<BroadPhase> make_broad_phase(const std::string& name, Executor& executor) {
  std::string known;
  for (const Method& m : methods) {
    if (name == m.name) return m.make(executor);
    known += (known.empty() ? "" : ", ") + std::string(m.name);
  }
  throw InputError("--broad-phase: '" + name + "' is unknown; one of " + known);
}

}  // namespace collidoscope

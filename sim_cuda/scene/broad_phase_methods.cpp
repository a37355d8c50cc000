#include "sim_cuda/scene/broad_phase_methods.h"

#include <deque>
#include <mutex>

#include "sim_cuda/core/error.h"

namespace collidoscope {
namespace {

/// Methods of plug-ins. A deque, so that pointers to them stay valid.
struct AddedMethods {
  std::mutex mutex;
  std::deque<BroadPhaseMethod> methods;
};
AddedMethods& added_methods() {
  static AddedMethods added;
  return added;
}

/// Calls visit(method) for each method of this build.
template <class Visit>
void for_each_built(const Visit& visit) {
  for (const BroadPhaseMethod& method : broad_phase_methods)
    if (is_built(method)) visit(method);
  AddedMethods& added = added_methods();
  const std::lock_guard lock(added.mutex);
  for (const BroadPhaseMethod& method : added.methods)
    if (!method.is_replaced) visit(method);
}

}  // namespace

bool is_built(const BroadPhaseMethod& method) {
#if SIM_BULLET
  constexpr bool has_bullet = true;
#else
  constexpr bool has_bullet = false;
#endif
  return has_bullet || !method.needs_bullet;
}

void add_broad_phase(const BroadPhaseMethod& method) {
  const auto refuse = [&] {
    throw InputError(std::string(method.file) + ": there is already a broad phase with the name " +
                     method.name);
  };
  for (const BroadPhaseMethod& known : broad_phase_methods)
    if (std::string_view(known.name) == method.name) refuse();
  AddedMethods& added = added_methods();
  const std::lock_guard lock(added.mutex);
  for (BroadPhaseMethod& known : added.methods) {
    if (known.is_replaced || std::string_view(known.name) != method.name) continue;
    if (known.file != method.file) refuse();
    known.is_replaced = true;
  }
  added.methods.push_back(method);
}

std::vector<std::string> broad_phase_names() {
  std::vector<std::string> names;
  for_each_built([&](const BroadPhaseMethod& method) { names.emplace_back(method.name); });
  return names;
}

std::vector<std::string> broad_phase_names_on(bool on_gpu) {
  std::vector<std::string> names;
  for_each_built([&](const BroadPhaseMethod& method) {
    if (!(on_gpu ? method.cpu_only : method.gpu_only)) names.emplace_back(method.name);
  });
  return names;
}

const BroadPhaseMethod* find_broad_phase(const std::string& name) {
  const BroadPhaseMethod* found = nullptr;
  for_each_built([&](const BroadPhaseMethod& method) {
    if (name == method.name) found = &method;
  });
  return found;
}

bool has_morton_keys(const std::string& name) {
  const BroadPhaseMethod* method = find_broad_phase(name);
  return method != nullptr && method->morton;
}

bool is_plugin(const std::string& name) {
  const BroadPhaseMethod* method = find_broad_phase(name);
  return method != nullptr && method->plugin != nullptr;
}

std::vector<std::string> plugin_notes(PairComparison comparison) {
  std::vector<std::string> notes;
  for_each_built([&](const BroadPhaseMethod& method) {
    if (method.plugin == nullptr) return;
    const char* state = method.has_wrong_pairs             ? "WRONG PAIRS in its tests"
                        : comparison == PairComparison::on ? "pairs compared"
                                                           : "pairs not compared";
    notes.push_back(std::string(method.name) + ": plug-in " + std::string(method.file) + ", " + state);
  });
  return notes;
}

}  // namespace collidoscope

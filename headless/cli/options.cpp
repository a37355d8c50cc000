#include "headless/cli/options.h"

#include <fmt/format.h>

#include <utility>

#include "headless/cli/flag_value.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/fault_lines.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {
namespace {

/// Which flag set the value at a path of the scene, "" if none did.
std::string_view flag_of(const std::string& path, const Overrides& overrides) {
  const std::pair<bool, std::pair<std::string_view, std::string_view>> set[] = {
      {overrides.bodies.has_value(), {"generators[0].count", "--bodies"}},
      {overrides.variant.has_value(), {"generators[0].variant", "--variant"}},
      {overrides.spawn.has_value(), {"generators[0].spawn", "--spawn"}},
      {overrides.seed.has_value(), {"generators[0].seed", "--seed"}},
      {overrides.gravity.has_value(), {"gravity", "--gravity"}},
      {overrides.time_step.has_value() || overrides.steps_per_second.has_value(),
       {"time_step", "--time-step"}},
      {overrides.steps_per_second.has_value(), {"steps_per_second", "--time-step"}},
      {overrides.substeps.has_value(), {"substeps", "--substeps"}},
      {overrides.iterations.has_value(), {"iterations", "--iterations"}},
      {overrides.effects.has_value(), {"effects", "--effects"}},
      {overrides.restitution_threshold.has_value(), {"restitution_threshold", "--restitution-threshold"}},
      {overrides.bodies.has_value(), {"bodies", "--bodies"}},  // of a total that is too large
  };
  for (const auto& [given, names] : set)
    if (given && path == names.first) return names.second;
  return "";
}

}  // namespace

void apply(const Overrides& overrides, const std::string& file, Scene& scene) {
  std::vector<std::string> faults;
  const auto set = [](auto& value, const auto& override) {
    if (override) value = *override;
  };
  const auto set_generated = [&](const char* flag, auto BoxCollider::*field, const auto& override) {
    if (!override) return;
    if (scene.generators.size() == 1)
      scene.generators[0].*field = *override;
    else
      faults.push_back(
          fmt::format("{}: {} has {} generators; it needs a scene with exactly one", flag, shown(file),
                      scene.generators.empty() ? "no" : fmt::to_string(scene.generators.size())));
  };
  set_generated("--bodies", &BoxCollider::count, overrides.bodies);
  set_generated("--variant", &BoxCollider::variant, overrides.variant);
  set_generated("--spawn", &BoxCollider::spawn, overrides.spawn);
  set_generated("--seed", &BoxCollider::seed, overrides.seed);

  Physics& physics = scene.physics;
  set(physics.gravity, overrides.gravity);
  set(physics.substeps, overrides.substeps);
  set(physics.iterations, overrides.iterations);
  set(physics.solver, overrides.solver);
  set(physics.integrator, overrides.integrator);
  set(physics.rotation_update, overrides.rotation_update);
  set(physics.precision, overrides.precision);
  set(physics.effects, overrides.effects);
  set(physics.restitution_threshold, overrides.restitution_threshold);
  if (overrides.guards) {
    if (!*overrides.guards)
      disable_guards(physics);
    else if (physics.guards)
      physics.guards->on_failure = **overrides.guards;
    else
      physics.guards.emplace().on_failure = **overrides.guards;
    if (*overrides.guards && physics.effects) physics.effects->guards = true;
  }
  if (overrides.time_step) {
    physics.time_step = *overrides.time_step;
    physics.steps_per_second.reset();
  } else if (overrides.steps_per_second) {
    physics.steps_per_second = overrides.steps_per_second;
    physics.time_step = 1.0 / *overrides.steps_per_second;
  }

  std::vector<Fault> of_file;
  for (const Fault& fault : validate(scene)) {
    const std::string_view flag = flag_of(fault.path, overrides);
    if (flag.empty())
      of_file.push_back(fault);
    else
      faults.push_back(fmt::format("{}: {}", flag, fault.message));
  }
  for (const std::string& line : fault_lines(scene, of_file)) faults.push_back(line);
  if (!faults.empty()) throw InputError(faults);
}

}  // namespace collidoscope

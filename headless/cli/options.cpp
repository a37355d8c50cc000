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
std::string flag_of(const std::string& path, const SettingsPatch& settings) {
  std::string flag;
  settings.for_each_set([&]<auto member>(const Field<member>& setting, const auto&) {
    const bool of_rate = is_field<member, &Physics::time_step> && path == "steps_per_second";
    const bool of_total = is_field<member, &BoxCollider::count> && path == "bodies";  // which is too large
    if (of_rate || of_total || path == path_of(setting)) flag = flag_name(setting.name);
  });
  return flag;
}

}  // namespace

void apply(const Overrides& overrides, const std::string& file, Scene& scene) {
  std::vector<std::string> faults;
  if (scene.generators.size() == 1) {
    apply(overrides.settings, scene);
  } else {
    SettingsPatch others = overrides.settings;
    overrides.settings.for_each_set([&]<auto member>(const Field<member>& setting, const auto&) {
      if (!is_of_generator(setting)) return;
      others.get<member>().reset();
      faults.push_back(
          fmt::format("{}: {} has {} generators, expected exactly one", flag_name(setting.name), shown(file),
                      scene.generators.empty() ? "no" : fmt::to_string(scene.generators.size())));
    });
    apply(others, scene);
  }
  Physics& physics = scene.physics;
  if (overrides.guards) {
    if (!*overrides.guards)
      disable_guards(physics);
    else if (physics.guards)
      physics.guards->on_failure = **overrides.guards;
    else
      physics.guards.emplace().on_failure = **overrides.guards;
    if (*overrides.guards && physics.effects) physics.effects->guards = true;
  }
  std::vector<Fault> of_file;
  for (const Fault& fault : validate(scene)) {
    const std::string flag = flag_of(fault.path, overrides.settings);
    if (flag.empty())
      of_file.push_back(fault);
    else
      faults.push_back(fmt::format("{}: {}", flag, fault.message));
  }
  for (const std::string& line : fault_lines(scene, of_file)) faults.push_back(line);
  if (!faults.empty()) throw InputError(faults);
}

}  // namespace collidoscope

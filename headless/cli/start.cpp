// The start of a run: a scene file, or a snapshot, with the overrides of the command line.

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "headless/cli/command_line.h"
#include "headless/cli/flag_value.h"
#include "sim_cuda/changes/changes.h"
#include "sim_cuda/core/assets.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/recording/recording_file.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {

Scene load_scene(const CommandLine& line) {
  const std::string file = scene_file(line.operands[0]);
  Scene scene = read_scene(file);
  for (const std::string& warning : scene.warnings) fmt::print(stderr, "{}\n", warning);
  apply(line.options.overrides, file, scene);
  constexpr unsigned guarded = bit(Command::run) | bit(Command::capture) | bit(Command::view);
  if (!(guarded & bit(line.command))) disable_guards(scene.physics);
  return scene;
}

namespace {

/// Flags that ask for other bodies than those of the snapshot. Throws InputError.
void refuse_other_bodies(const SettingsPatch& settings, const std::string& file, const Scene& saved) {
  std::vector<std::string> faults;
  settings.for_each_set([&]<auto member>(const Field<member>& setting, const auto& value) {
    if (!is_of_generator(setting)) return;
    Scene scene = saved;
    apply(SettingsPatch().set<member>(value), scene);
    if (!requires_restart(saved, scene)) return;
    const std::string flag = flag_name(setting.name);
    faults.push_back(fmt::format("{}: {} has different bodies; remove {}, or give SCENE instead of --load",
                                 flag, shown(file), flag));
  });
  if (!faults.empty()) throw InputError(faults);
}

void note_other_physics(std::int64_t version, const std::string& file) {
  if (version == physics_version) return;
  fmt::print(stderr,
             "note: {} was written by physics version {}; this program has version {}, so the run continues "
             "differently\n",
             shown(file), version, physics_version);
}

}  // namespace

Start load_start(const CommandLine& line) {
  std::string file = line.options.load;
  if (file.empty() && is_recording(line.operands[0])) file = line.operands[0];
  Start start;
  if (file.empty()) {
    start.scene = load_scene(line);
    return start;
  }
  if (is_recording(file)) start.recording = std::make_shared<const RecordingReader>(file);
  start.snapshot = start.recording ? last_keyframe(*start.recording) : read_snapshot(file);
  start.scene = start.snapshot->scene;
  apply(line.options.overrides, file, start.scene);
  refuse_other_bodies(line.options.overrides.settings, file, start.snapshot->scene);
  note_other_physics(start.snapshot->physics_version, file);
  // With other settings, the run continues from the last keyframe alone.
  if (start.snapshot->physics_version != physics_version ||
      write_scene(start.scene) != write_scene(start.snapshot->scene))
    start.recording = nullptr;
  return start;
}

World Start::world(const RunOptions& options) const {
  return snapshot ? world_from(*snapshot, scene, options) : World(scene, options);
}

std::string scene_file(const std::string& given) {
  namespace fs = std::filesystem;
  std::error_code failed;
  if (given.empty()) throw InputError("'': neither a file nor the name of a scene");
  const bool bare = given.find('/') == std::string::npos && !given.ends_with(".json");
  if (!bare || fs::exists(given, failed)) return given;
  std::vector<std::string> names;
  for (const fs::path& folder : asset_folders()) {
    const bool first = names.empty();
    for (const fs::path& scenes : {folder / "scenes", folder / "scenes" / "analytic"}) {
      const fs::path file = scenes / (given + ".json");
      if (fs::exists(file, failed)) return file.string();
      if (!first) continue;
      for (const auto& entry : fs::directory_iterator(scenes, failed))
        if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
    }
  }
  std::ranges::sort(names);
  throw InputError(fmt::format("{}: neither a file nor the name of a scene; {}", shown(given),
                               names.empty() ? "folder assets/scenes not found"
                                             : fmt::format("expected one of {}", fmt::join(names, ", "))));
}

}  // namespace collidoscope

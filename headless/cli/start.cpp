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
#include "sim_cuda/import/file_format.h"
#include "sim_cuda/import/table_file.h"
#include "sim_cuda/recording/recording_file.h"
#include "sim_cuda/scene/imported_scene.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {

namespace {

/// A scene file, or a file of another program. A name that ends in .json, or is no regular file, is a scene.
Scene scene_of_any_file(const std::string& file, const ImportOptions& import) {
  std::error_code failed;
  const bool is_scene = file.ends_with(".json") || !std::filesystem::is_regular_file(file, failed);
  const FileFormat format = is_scene ? FileFormat::scene : format_of(file);
  if (format == FileFormat::unknown)
    throw InputError(
        fmt::format("{}: unknown format, expected a scene, snapshot, recording, or bodies as NPY, NPZ, CSV, "
                    "XYZ, LAMMPS dump, "
                    "PLY, OBJ, STL, URDF or MJCF",
                    shown(file)));
  if (format != FileFormat::scene) return import_scene(file, format, import);
  if (import.any())
    throw InputError(fmt::format(
        "--columns, --radius, --scale, --frame: {} is a scene, expected a file of bodies", shown(file)));
  return read_scene(file);
}

/// Scene files are JSON.
bool is_imported(const Scene& scene) {
  std::error_code failed;
  return !scene.file.ends_with(".json") && std::filesystem::is_regular_file(scene.file, failed) &&
         format_of(scene.file) != FileFormat::scene;
}

}  // namespace

Scene load_scene(const CommandLine& line) {
  const BenchRequest& given = line.options.bench;
  const std::string file = given.boxes.empty() ? scene_file(line.operands[0]) : given.boxes;
  if (given.boxes.empty() && !given.tree.empty())
    throw InputError("--tree: needs the boxes of its leaves, expected --boxes FILE.npy");
  Scene scene = given.boxes.empty() ? scene_of_any_file(file, line.options.import)
                                    : import_boxes(given.boxes, given.tree);
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

/// The frames of a file with several, or of several files; else none.
std::vector<BodyTable> read_frames(const CommandLine& line, const Scene& scene) {
  const ImportOptions& import = line.options.import;
  const TableOptions options{parse_column_map(import.columns, "--columns"), import.scale, import.frame};
  if (line.operands.size() > 1) {
    if (scene.body_files.empty())
      throw InputError(fmt::format("{}: {} files, expected one, or a series of files of bodies",
                                   shown(line.operands[0]), line.operands.size()));
    return read_body_series(line.operands, options);
  }
  if (scene.body_files.empty() || scene.body_files[0].table->frames - import.frame < 2) return {};
  return read_body_frames(scene.file, format_of(scene.file), options);
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
  if (file.empty() && line.options.bench.boxes.empty()) {
    const std::string& given = line.operands[0];
    std::error_code failed;
    if (is_recording(given) ||
        (std::filesystem::is_regular_file(given, failed) && format_of(given) == FileFormat::snapshot))
      file = given;
  }
  Start start;
  if (file.empty()) {
    start.scene = load_scene(line);
    start.imported = is_imported(start.scene);
    if ((line.command == Command::view || line.command == Command::capture) &&
        (start.imported || line.operands.size() > 1))
      start.frames = read_frames(line, start.scene);
    return start;
  }
  if (line.options.import.any())
    throw InputError(fmt::format(
        "--columns, --radius, --scale, --frame: {} has its bodies, expected a file of bodies", shown(file)));
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

std::string imported_notice(const Scene& scene) {
  std::string notice;
  const std::string prefix = scene.file + ": ";
  for (const std::string& line : scene.warnings)
    notice += (notice.empty() ? "" : "; ") + line.substr(line.starts_with(prefix) ? prefix.size() : 0);
  return notice;
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
  std::string scenes_folder;
  for (const fs::path& folder : asset_folders()) {
    const bool first = names.empty();
    if (first) scenes_folder = folder / "scenes";
    for (const fs::path& scenes : {folder / "scenes", folder / "scenes" / "analytic"}) {
      const fs::path file = scenes / (given + ".json");
      if (fs::exists(file, failed)) return file.string();
      if (!first) continue;
      for (const auto& entry : fs::directory_iterator(scenes, failed))
        if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
    }
  }
  std::ranges::sort(names);  // equally similar names: the first
  const std::vector<std::string_view> views(names.begin(), names.end());
  const std::string_view nearest = nearest_name(given, views);
  throw InputError(fmt::format(
      "{}: neither a file nor the name of a scene; {}", shown(given),
      names.empty() ? "folder assets/scenes not found"
                    : fmt::format("{} ({} scenes are in {})",
                                  nearest.empty() ? "expected a file, or a name such as box_collider"
                                                  : fmt::format("did you mean \"{}\"?", nearest),
                                  names.size(), scenes_folder)));
}

}  // namespace collidoscope

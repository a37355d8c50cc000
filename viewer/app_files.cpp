// Files that are dropped on the window replace the run. If a file cannot be opened, the run continues.

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "sim_cuda/core/assets.h"
#include "sim_cuda/core/atomic_file.h"
#include "sim_cuda/core/cancellation.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/import/columns.h"
#include "sim_cuda/import/table_file.h"
#include "sim_cuda/plugin/library.h"
#include "sim_cuda/plugin/validation.h"
#include "sim_cuda/recording/series.h"
#include "sim_cuda/snapshot/snapshot.h"
#include "viewer/app_error_bar.h"
#include "viewer/unused_file_name.h"

namespace collidoscope {

namespace {

const std::vector<std::string>& body_quantity_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (std::size_t k = 0; k < quantity_count; ++k)
      all.emplace_back(info_of(static_cast<BodyQuantity>(k)).name);
    return all;
  }();
  return names;
}

/// The flag --columns of a choice. Columns whose names would be recognised, but are not used, are "none".
std::string columns_flag(const ColumnsDialog& dialog, bool has_names) {
  std::string flag;
  for (std::size_t quantity = 0; quantity < quantity_count; ++quantity) {
    const auto column = std::ranges::find(dialog.meaning, static_cast<int>(quantity));
    const auto is_recognised = [&](const std::string& name) {
      return quantity_of_column(name) == static_cast<BodyQuantity>(quantity);
    };
    std::string place;
    if (column != dialog.meaning.end())
      place = std::to_string(column - dialog.meaning.begin() + 1);
    else if (has_names && std::ranges::any_of(dialog.names, is_recognised))
      place = "none";
    else
      continue;
    flag += (flag.empty() ? "" : ",") + body_quantity_names()[quantity] + "=" + place;
  }
  return flag;
}

/// The choice for a file, with the columns that `import` and the names give.
ColumnsDialog dialog_of(const std::string& file, const ImportOptions& import) {
  const FileFormat format = format_of(file);
  const TablePreview preview = preview_body_table(file, format, import.frame);
  ColumnsDialog dialog;
  dialog.open = true;
  dialog.file = file;
  dialog.format = std::string(description_of(format));
  dialog.has_names = !preview.names.empty();
  dialog.names = preview.names;
  for (std::size_t k = dialog.names.size(); k < preview.columns; ++k)
    dialog.names.push_back(std::to_string(k + 1));
  dialog.rows = preview.rows;
  dialog.quantities = body_quantity_names();
  dialog.meaning.assign(preview.columns, -1);
  dialog.scale = import.scale;
  dialog.radius = import.radius.value_or(0);
  dialog.frame = import.frame;
  try {
    const ColumnChoice choice =
        choose_columns(parse_column_map(import.columns, "--columns"), preview.names, preview.columns, file);
    for (std::size_t k = 0; k < quantity_count; ++k)
      if (choice.column[k]) dialog.meaning[*choice.column[k]] = static_cast<int>(k);
  } catch (const InputError&) {
    for (std::size_t k = 0; k < preview.names.size(); ++k)
      if (const auto quantity = quantity_of_column(preview.names[k]);
          quantity && std::ranges::find(dialog.meaning, static_cast<int>(*quantity)) == dialog.meaning.end())
        dialog.meaning[k] = static_cast<int>(*quantity);
  }
  return dialog;
}

/// Why a file cannot be opened with these columns, or empty.
std::string columns_fault(const ColumnsDialog& dialog) {
  try {
    const std::string flag = columns_flag(dialog, dialog.has_names);
    if (flag.empty()) return "choose the columns of x, y and z";
    std::span<const std::string> names;
    if (dialog.has_names) names = dialog.names;
    choose_columns(parse_column_map(flag, "--columns"), names, dialog.names.size(), "");
  } catch (const InputError& error) {
    std::string text = error.what();
    text.erase(0, text.starts_with(": ") ? 2 : 0);
    return text.substr(0, text.find(';'));  // without the flag
  }
  return "";
}

bool is_table(const std::string& file) {
  switch (format_of(file)) {
    case FileFormat::npy:
    case FileFormat::npz:
    case FileFormat::csv:
    case FileFormat::xyz:
    case FileFormat::lammps:
    case FileFormat::ply:
      return true;
    default:
      return false;
  }
}

/// Whether a file is a program or a library.
bool is_library(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  char magic[4] = {};
  return stream.read(magic, 4) && std::memcmp(magic, "\177ELF", 4) == 0;
}

/// The file for the run before a plug-in is loaded. Creates its folder.
std::string file_before_plugin(const std::string& plugin) {
  const std::filesystem::path folder = cache_folder();
  if (folder.empty()) return unused_file_name("before_" + plugin, "snapshot");
  std::filesystem::create_directories(folder);
  return (folder / ("before_" + plugin + ".snapshot")).string();
}

}  // namespace

/// Tests and loads a plug-in after the user has agreed, and uses it for the run.
void App::follow_plugin() {
  if (!std::exchange(workspace_.plugin.confirmed, false)) return;
  workspace_.plugin.open = false;
  struct Loaded {
    std::string name, snapshot;
    std::size_t tests, faults;
  };
  const auto loaded = std::make_shared<Loaded>();
  const std::string path = workspace_.plugin.file;
  begin({"testing " + path,
         [this, path, loaded] {
           ValidationOptions how;
           how.gpu = std::max(live_.world().options().gpu, 0);
           how.poll = [cancellation = options_.run.cancellation] {
             if (cancellation != nullptr && cancellation->requested()) throw Cancelled();
           };
           const PluginValidation validation = validate_plugin(path, how);
           if (!validation.ended.empty())
             throw InputError(path + ": " + validation.ended + "; it is not loaded");
           std::string bytes;
           write_snapshot(snapshot_of(live_.world()), [&](std::string_view more) { bytes += more; });
           loaded->snapshot = file_before_plugin(validation.name);
           write_file_atomically(loaded->snapshot, bytes);
           loaded->tests = validation.tests.size();
           loaded->faults = validation.faults().size();
           loaded->name = load_plugin(path, validation.identity, loaded->faults > 0);
         },
         [this, loaded] {
           workspace_.settings.run.broad_phase = loaded->name;
           const std::string result =
               loaded->faults == 0 ? std::to_string(loaded->tests) + " tests passed"
                                   : std::to_string(loaded->faults) + " of " + std::to_string(loaded->tests) +
                                         " tests failed, so its pairs are compared in each step";
           show_notice("plug-in " + loaded->name + ": " + result + "; the run is saved in " +
                       loaded->snapshot);
         }});
}

void App::open_dropped_files() {
  if (window_.dropped_files().empty()) return;
  if (const std::string& file = window_.dropped_files()[0];
      window_.dropped_files().size() == 1 && is_library(file)) {
    workspace_.plugin = {true, full_plugin_path(file)};
    return window_.forget_dropped_files();
  }
  CommandLine line;
  line.command = Command::view;
  line.operands = window_.dropped_files();
  sort_by_numbers(line.operands);
  window_.forget_dropped_files();
  open_files(std::move(line));
}

/// Replaces the run. If the columns of a file are not known, they are asked for.
void App::open_files(CommandLine line) {
  workspace_.columns.open = false;
  const auto start = std::make_shared<Start>();
  const auto dialog = std::make_shared<ColumnsDialog>();
  begin({"opening " + line.operands[0],
         [this, line, start, dialog] {
           try {
             *start = load_start(line);
           } catch (const InputError&) {
             if (line.operands.size() > 1 || !is_table(line.operands[0])) throw;
             ColumnsDialog choice = dialog_of(line.operands[0], line.options.import);
             if (columns_fault(choice).empty()) throw;
             *dialog = std::move(choice);
             return;
           }
           World world = start->world(live_.world().options());
           std::optional<RecordedRun> run;  // before the present run ends, since it may fail
           if (start->recording) run = read_run(*start->recording);
           if (!start->frames.empty()) run = run_of_frames(world, start->frames);
           live_.open(std::move(world));
           if (run) live_.take_recording(std::move(*run));
         },
         [this, start, dialog] {
           if (dialog->open) {
             workspace_.columns = *dialog;
             return;
           }
           run_before_cases_.reset();
           stability_.no_case_shown();
           show_another_scene();
           workspace_.playing = false;
           options_.view.pause_at.reset();
           show_import(*start);
         }});
}

void App::follow_columns() {
  ColumnsDialog& dialog = workspace_.columns;
  const Scene& scene = live_.world().scene();
  if (std::exchange(workspace_.columns_requested, false) && scene.body_files.size() == 1) {
    const BodyFile& file = scene.body_files[0];
    ImportOptions present{file.columns, {}, file.scale, file.frame};
    if (file.table->radius.empty()) present.radius = file.radius;
    dialog =
        dialog_of((std::filesystem::path(scene.directory) / file.path).lexically_normal().string(), present);
  }
  if (!dialog.open) return;
  dialog.fault = columns_fault(dialog);
  if (!std::exchange(dialog.confirmed, false) || !dialog.fault.empty()) return;
  CommandLine line;
  line.command = Command::view;
  line.operands = {dialog.file};
  ImportOptions& import = line.options.import;
  import.columns = columns_flag(dialog, dialog.has_names);
  import.scale = dialog.scale;
  import.frame = dialog.frame;
  const auto has = [&](BodyQuantity quantity) {
    return std::ranges::find(dialog.meaning, static_cast<int>(quantity)) != dialog.meaning.end();
  };
  if (dialog.radius > 0 && !has(BodyQuantity::radius) && !has(BodyQuantity::diameter))
    import.radius = dialog.radius;
  open_files(std::move(line));
}

/// An imported scene pauses at its first state. One with several frames pauses at the last one.
void App::show_import(const Start& start) {
  if (!start.imported) return;
  workspace_.playing = false;
  if (start.has_boxes()) {
    workspace_.layers.spheres = false;
    workspace_.layers.boxes = workspace_.levels_chosen = true;
    workspace_.layers.first_level = 0;
    workspace_.layers.last_level = TreeView::last_level;
    workspace_.visible_panels.right = workspace_.visible_panels.tree = true;
  }
  std::string notice = imported_notice(start.scene);
  if (!start.frames.empty()) {
    const std::int64_t last = std::ssize(start.frames) - 1;
    if (!options_.view.pause_at) options_.view.pause_at = last;
    notice += "; play shows the frames 0 to " + std::to_string(last);
  }
  show_notice(notice);
}

}  // namespace collidoscope

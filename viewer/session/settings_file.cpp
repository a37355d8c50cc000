#include "viewer/session/settings_file.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/text_file.h"

namespace collidoscope {
namespace {

using Json = nlohmann::ordered_json;

constexpr int file_version = 1;

bool is_settings(const Json& document) {
  return document.is_object() && document.value("format", Json()) == "collidoscope-settings";
}

struct Switch {
  const char* name;
  bool& value;
};

std::vector<Switch> switches(FrameLayers& layers, PanelVisibility& visible_panels) {
  return {{"spheres", layers.spheres},
          {"boxes", layers.boxes},
          {"contacts", layers.contacts},
          {"grid", layers.grid},
          {"walls", layers.walls},
          {"joints", layers.joints},
          {"ghosts", layers.ghosts},
          {"errors", layers.errors},
          {"left", visible_panels.left},
          {"right", visible_panels.right},
          {"bottom", visible_panels.bottom},
          {"run", visible_panels.run},
          {"settings", visible_panels.settings},
          {"layers", visible_panels.layers},
          {"camera", visible_panels.camera},
          {"tree", visible_panels.tree},
          {"effects", visible_panels.effects},
          {"timing", visible_panels.timing},
          {"numbers", visible_panels.numbers},
          {"inspector", visible_panels.inspector},
          {"convergence", visible_panels.convergence},
          {"accuracy", visible_panels.accuracy},
          {"launch_map", visible_panels.launch_map},
          {"hard_cases", visible_panels.hard_cases},
          {"breaks", visible_panels.breaks}};
}

}  // namespace

std::string settings_path() {
  const char* config = std::getenv("XDG_CONFIG_HOME");
  if (config != nullptr && config[0] == '/') return std::string(config) + "/collidoscope/settings.json";
  const char* home = std::getenv("HOME");
  return home != nullptr && home[0] != 0 ? std::string(home) + "/.config/collidoscope/settings.json" : "";
}

std::string settings_text(const Workspace& workspace) {
  FrameLayers layers = workspace.layers;
  PanelVisibility visible_panels = workspace.visible_panels;
  Json document = {{"format", "collidoscope-settings"},
                   {"version", file_version},
                   {"theme", workspace.theme == Theme::light ? "light" : "dark"},
                   {"font_scale", workspace.font_scale},
                   {"speed", workspace.speed},
                   {"first_level", layers.first_level},
                   {"last_level", layers.last_level},
                   {"color", static_cast<int>(layers.color)},
                   {"box_color", static_cast<int>(layers.box_color)},
                   {"levels_chosen", workspace.levels_chosen},
                   {"show_path", workspace.show_path}};
  for (const Switch& one : switches(layers, visible_panels)) document["shown"][one.name] = one.value;
  for (const BreakConditionName& each : break_condition_names)
    if (each.has_limit) document["break_limits"][each.name] = workspace.breaks.limit(each.condition);
  return document.dump(2) + '\n';
}

std::string read_settings(const std::string& text, Workspace& workspace) {
  const Json document = Json::parse(text, nullptr, false);
  if (!is_settings(document))
    return "not a settings file of Collidoscope; it is ignored and overwritten at exit";
  if (document.value("version", Json(file_version)) != file_version)
    return "settings of another version of Collidoscope; the file is neither read nor written";
  const auto number = [&](const char* name, double low, double high, auto& value) {
    const auto found = document.find(name);
    if (found == document.end() || !found->is_number()) return;
    const double given = found->get<double>();
    if (given >= low && given <= high) value = static_cast<std::remove_reference_t<decltype(value)>>(given);
  };
  if (document.value("theme", Json()) == "light") workspace.theme = Theme::light;
  number("font_scale", 0.6, 3, workspace.font_scale);
  double speed = workspace.speed;
  number("speed", 0, 2, speed);
  if (std::ranges::find(speed_choices, speed, &SpeedChoice::speed) != speed_choices.end())
    workspace.speed = speed;
  int first = 0, last = 63, color = 0, box_color = 0;
  number("first_level", 0, 63, first);
  number("last_level", 0, 63, last);
  number("color", 0, static_cast<int>(BodyColor::error), color);
  number("box_color", 0, static_cast<int>(NodeMetric::visits), box_color);
  workspace.layers.first_level = std::min(first, last);
  workspace.layers.last_level = std::max(first, last);
  workspace.layers.color = static_cast<BodyColor>(color);
  workspace.layers.box_color = static_cast<NodeMetric>(box_color);
  for (const auto& [name, value] : {std::pair<const char*, bool&>{"show_path", workspace.show_path},
                                    {"levels_chosen", workspace.levels_chosen}})
    if (document.value(name, Json()).is_boolean()) value = document[name].get<bool>();
  const Json shown = document.value("shown", Json::object());
  if (shown.is_object())
    for (const Switch& one : switches(workspace.layers, workspace.visible_panels))
      if (shown.contains(one.name) && shown[one.name].is_boolean()) one.value = shown[one.name].get<bool>();
  const Json limits = document.value("break_limits", Json::object());
  for (const BreakConditionName& each : break_condition_names) {
    if (!each.has_limit || !limits.contains(each.name)) continue;
    const Json& limit = limits[each.name];
    if (limit.is_number() && limit >= 0 && limit <= each.max_limit)
      workspace.breaks.limit(each.condition) = limit.get<double>();
  }
  return "";
}

RememberedSettings read_settings_file(const std::string& file, Workspace& workspace) {
  std::error_code failed;
  if (!std::filesystem::exists(file, failed)) return {};
  if (!std::filesystem::is_regular_file(file, failed))
    return {file + ": not a regular file; settings are neither read nor written", false};
  try {
    const std::string text = read_text_file(file, std::size_t{1} << 20, "a settings file");
    const std::string fault = read_settings(text, workspace);
    if (fault.empty()) return {};
    return {file + ": " + fault, !is_settings(Json::parse(text, nullptr, false))};
  } catch (const InputError& error) {
    return {error.what()};
  }
}

}  // namespace collidoscope

#include "viewer/session/automation.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/field_json.h"
#include "sim_cuda/scene/names.h"

namespace collidoscope {

namespace {

/// Contents of the tree panel; null while it is folded.
nlohmann::ordered_json tree_json(const Workspace& workspace, const WorkspaceView& view) {
  using Json = nlohmann::ordered_json;
  if (view.tree == nullptr) return nullptr;
  const TreePanelView& panel = *view.tree;
  const TreeRequests& requests = workspace.tree;
  Json tree = {{"step", panel.step},
               {"nodes", panel.quality.nodes},
               {"sah", panel.quality.sah},
               {"took_ms", panel.took_ms},
               {"sort", static_cast<int>(requests.sort)},
               {"first", panel.first},
               {"ranked", panel.ranked},
               {"range", {workspace.layers.box_low, workspace.layers.box_high}},
               {"inside", panel.histogram.inside},
               {"visit", static_cast<int>(requests.visit)},
               {"visits", panel.visits}};
  tree["node"] = requests.node ? Json(*requests.node) : Json(nullptr);
  for (const NodeReport& row : panel.rows)
    tree["rows"].push_back({{"node", row.node}, {"visits", row.visits}});
  return tree;
}

/// Contents of the effects panel; null while it is folded.
nlohmann::ordered_json effects_json(const WorkspaceView& view) {
  nlohmann::ordered_json effects;
  for (const EffectView& effect : view.effect_views) {
    auto& one = effects[effect.name];
    one = {{"on", effect.on}, {"called_for", effect.required}};
    if (effect.cost)
      one["cost"] = {{"pairs", effect.cost->ratio.pairs},
                     {"ms", effect.cost->ms()},
                     {"bytes", effect.cost->bytes},
                     {"lack", effect.cost->unavailable_reason}};
  }
  return effects;
}

/// Contents of the accuracy panel; null while it is folded.
nlohmann::ordered_json accuracy_json(const Workspace& workspace, const WorkspaceView& view) {
  using Json = nlohmann::ordered_json;
  if (view.accuracy == nullptr) return nullptr;
  const AccuracyView& panel = *view.accuracy;
  Json accuracy = {{"tolerance", workspace.accuracy.tolerance},
                   {"running", workspace.accuracy.running || view.measuring},
                   {"since", panel.start_state},
                   {"done", panel.done},
                   {"doing", panel.current_task},
                   {"lack", panel.unavailable_reason},
                   {"reference", panel.reference ? Json(panel.reference->description) : Json(nullptr)},
                   {"cheapest", panel.cheapest ? Json(*panel.cheapest) : Json(nullptr)},
                   {"no_choice", panel.no_recommendation_reason},
                   {"now", nullptr},
                   {"points", Json::array()}};
  for (std::size_t k = 0; k < panel.points.size(); ++k) {
    const AccuracyPoint& p = panel.points[k];
    if (p.setting == panel.now) accuracy["now"] = k;
    if (p.has_error() && p.has_cost())
      accuracy["points"].push_back({{"point", k}, {"error", p.error}, {"ms", p.ms.median}});
  }
  for (const AccuracyPlace& place : workspace.accuracy.places)
    accuracy["places"].push_back({{"point", place.point}, {"at", {place.x, place.y}}});
  if (workspace.accuracy.line) accuracy["line"] = {workspace.accuracy.line->x, workspace.accuracy.line->y};
  return accuracy;
}

/// Contents of the launch map panel; null while it is folded.
nlohmann::ordered_json launch_map_json(const Workspace& workspace, const WorkspaceView& view) {
  using Json = nlohmann::ordered_json;
  if (view.launch_map == nullptr) return nullptr;
  const LaunchMapView& panel = *view.launch_map;
  Json map = {{"running", workspace.launch_map.running || view.measuring},
              {"done", panel.done},
              {"spent", panel.spent},
              {"budget", panel.budget},
              {"state", panel.start_state},
              {"now", {panel.now.blocks, panel.now.threads}},
              {"lack", panel.unavailable_reason},
              {"verdict", panel.verdict},
              {"cells", Json::array()}};
  map["chosen"] = panel.chosen ? Json(*panel.chosen) : Json(nullptr);
  for (const LaunchCell& cell : panel.cells)
    map["cells"].push_back({{"shape", {cell.shape.blocks, cell.shape.threads}},
                            {"state", static_cast<int>(cell.state)},
                            {"pairs", cell.ratios.size()}});
  for (const LaunchMapPlace& place : workspace.launch_map.places)
    map["places"].push_back({{"cell", place.cell}, {"at", {place.x, place.y}}});
  return map;
}

/// Contents of the hard cases panel; null while it is folded.
nlohmann::ordered_json hard_cases_json(const Workspace& workspace, const WorkspaceView& view) {
  using Json = nlohmann::ordered_json;
  if (view.hard_cases == nullptr) return nullptr;
  const HardCasesView& panel = *view.hard_cases;
  Json cases = {{"lack", panel.unavailable_reason},
                {"doing", panel.current_task},
                {"opening", panel.opening ? Json(*panel.opening) : Json(nullptr)},
                {"selected", workspace.hard_cases.selected},
                {"before", panel.scene_before},
                {"shown", panel.shown ? Json(panel.cases[*panel.shown].name) : Json(nullptr)},
                {"marks", Json::object()}};
  for (const auto& [name, mark, help] : test_status_names)
    cases["counts"][std::string(name)] = panel.count(mark);
  for (const HardCaseView& one : panel.cases)
    for (const TestRunView& test_run : one.test_runs)
      cases["marks"][one.name][fmt::format("{} {}", name_of(solver_names, test_run.solver),
                                           name_of(precision_names, test_run.precision))] =
          std::string(name_of(test_status_names, test_run.status));
  return cases;
}

}  // namespace

Automation::Automation(const std::string& file) : file_(file) {
  errno = 0;
  stream_.open(file, std::ios::trunc);
  if (!stream_) throw InputError(fmt::format("{} cannot be written: {}", file, std::strerror(errno)));
}

void Automation::write(const Frame& frame, const Workspace& workspace, const WorkspaceView& view) {
  using Json = nlohmann::ordered_json;
  const Settings& s = view.active_settings;
  Json line = {{"frame", frame.frame},
               {"complete", frame.complete},
               {"releases", frame.releases},
               {"scene", view.scene},
               {"window", {frame.width, frame.height}},
               {"step", view.stats.step},
               {"playing", workspace.playing},
               {"timeline", view.timeline ? Json{view.timeline->first, view.timeline->last} : Json(nullptr)},
               {"backwards", workspace.backwards},
               {"edited", view.edited},
               {"changes", view.changes},
               {"bodies", view.stats.bodies},
               {"layers",
                {{"spheres", workspace.layers.spheres},
                 {"boxes", workspace.layers.boxes},
                 {"contacts", workspace.layers.contacts},
                 {"grid", workspace.layers.grid},
                 {"walls", workspace.layers.walls},
                 {"joints", workspace.layers.joints},
                 {"ghosts", workspace.layers.ghosts},
                 {"errors", workspace.layers.errors},
                 {"error_scale", view.error_scale},
                 {"first_level", workspace.layers.first_level},
                 {"last_level", workspace.layers.last_level},
                 {"color", static_cast<int>(workspace.layers.color)},
                 {"box_color", static_cast<int>(workspace.layers.box_color)}}},
               {"drawn", {{"spheres", frame.spheres}, {"boxes", frame.boxes}, {"contacts", frame.contacts}}},
               {"max_impulse", view.max_impulse},
               {"camera", frame.camera},
               {"orthographic", view.orthographic},
               {"ui_ms", frame.ui_ms},
               {"frames_per_second", view.frames_per_second},
               {"picture", frame.picture},
               {"wants_mouse", frame.wants_mouse},
               {"list_open", frame.list_open},
               {"pressed", workspace.pressed},
               {"help", workspace.help},
               {"light", workspace.theme == Theme::light},
               {"font_scale", workspace.font_scale},
               {"hovered_level", workspace.hovered_level},
               {"chosen_stage", workspace.chosen_stage},
               {"contact_rows", workspace.contact_rows.others},
               {"pairs", view.stats.pairs},
               {"contacts", view.stats.touching},
               {"pairs_note", view.pairs_note},
               {"faulty_pairs", view.faulty_pairs.size()},
               {"notice", workspace.notice},
               {"last_notice", workspace.last_notice}};  // tests on a busy machine may miss the notice itself
  for_each_setting([&]<auto member>(const Field<member>& setting) {
    using Owner = typename Field<member>::Owner;
    const auto& value = owner_in<Owner>(s).*member;
    if (setting.name == "bodies" || setting.name == "effects")
      return;  // N and the effects are written elsewhere
    if constexpr (std::is_same_v<Owner, LaunchShape>)
      line[std::string(setting.name)] = value;  // 0: auto
    else
      line[std::string(setting.name)] = value_json(setting, value);
  });
  line["marks"] = Json::array();
  line["other_run"] = nullptr;
  if (view.timeline) {
    for (const TimelineMark& mark : view.timeline->marks) line["marks"].push_back({mark.state, mark.text});
    if (const auto& other = view.timeline->other) line["other_run"] = {other->fork, other->last};
  }
  line["input_fault"] = workspace.input_fault ? Json(workspace.input_fault->text) : Json(nullptr);
  line["state_hash"] = frame.state_hash ? Json(fmt::format("{:016x}", *frame.state_hash)) : Json(nullptr);
  line["selection"] = workspace.selection ? Json(*workspace.selection) : Json(nullptr);
  line["tree"] = tree_json(workspace, view);
  line["effects"] = effects_json(view);
  line["reference"] = {{"name", view.reference.name},         {"lack", view.reference.unavailable_reason},
                       {"since", view.reference.start_state}, {"rms", view.reference.rms},
                       {"max", view.reference.max},           {"doubt", view.reference.error_estimate}};
  line["accuracy"] = accuracy_json(workspace, view);
  line["launch_map"] = launch_map_json(workspace, view);
  line["hard_cases"] = hard_cases_json(workspace, view);
  line["stop"] = nullptr;
  if (view.stop)
    line["stop"] = {{"what", view.stop->what},
                    {"found", view.stop->is_violation},
                    {"body", view.stop->body ? Json(*view.stop->body) : Json(nullptr)},
                    {"before", view.stop->state_before}};
  line["frozen"] = view.frozen;
  line["guards"] = s.guards ? Json(std::string(name_of(on_failure_names, *s.guards))) : Json(nullptr);
  line["measuring_effects"] = view.measuring_effects;
  line["error"] = workspace.errors.empty() ? Json(nullptr) : Json(workspace.errors.front());
  Json widgets = Json::object();
  for (const auto& [name, rect] : workspace.widgets)
    widgets[name] = {rect.x, rect.y, rect.width, rect.height};
  line["widgets"] = widgets;
  errno = 0;
  stream_ << line.dump(-1, ' ', false, Json::error_handler_t::replace) << '\n' << std::flush;
  if (!stream_) throw MachineError(fmt::format("{} cannot be written: {}", file_, std::strerror(errno)));
}

}  // namespace collidoscope

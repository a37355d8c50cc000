#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/settings.h"
#include "ui/launch_text.h"
#include "ui/number_field.h"
#include "ui/panels.h"
#include "ui/tree_widgets.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

// A logarithmic slider and a text field for a whole number.
struct LogRow {
  std::string name, label, help;
  std::int64_t low, high, limit;        ///< range of the slider; maximum of the field
  bool decides;                         ///< the setting affects the result
  const std::string* chosen = nullptr;  ///< set: 0 means "auto"; text of the automatic value, may be empty
  std::int64_t manual = 0;              ///< value after "auto" is switched off
  float column = 2, field = 5.4f;       ///< ems: position of the slider, width of the field
};

void log_row(Workspace& workspace, std::int64_t& value, const LogRow& row) {
  ImGui::PushID(row.name.c_str());
  const float size = ImGui::GetFontSize();
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(row.label.c_str());
  explain(row.help.c_str());
  ImGui::SameLine(size * row.column);
  const bool automatic = row.chosen != nullptr, is_auto = automatic && value == 0;
  const std::string text = is_auto ? (row.chosen->empty() ? "auto" : *row.chosen) : "";
  const float button = automatic ? ImGui::CalcTextSize("auto").x + 2 * ImGui::GetStyle().FramePadding.x : 0;
  const float gap = ImGui::GetStyle().ItemSpacing.x;
  const float input = size * row.field;
  ImGui::SetNextItemWidth(
      std::max(ImGui::GetContentRegionAvail().x - input - gap - (automatic ? button + gap : 0), size));
  std::int64_t shown = std::clamp(is_auto ? row.low : value, row.low, row.high);
  if (ImGui::SliderScalar(
          "##slider", ImGuiDataType_S64, &shown, &row.low, &row.high, text.c_str(),
          ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_NoInput | ImGuiSliderFlags_NoRoundToFormat))
    value = shown;
  workspace.adjusting |= ImGui::IsItemActive();
  workspace.adjusting_result |= row.decides && ImGui::IsItemActive();
  track(workspace, (row.name + ".slider").c_str());
  ImGui::SameLine();
  ImGui::SetNextItemWidth(input);
  number_field(workspace, row.name.c_str(), row.label.c_str(), value,
               NumberRange<std::int64_t>{row.low, row.limit, "", automatic}, "{}");
  if (automatic) {
    ImGui::SameLine();
    if (is_auto) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
    if (ImGui::Button("auto", {button, 0})) value = is_auto ? row.manual : 0;
    if (is_auto) ImGui::PopStyleColor();
    track(workspace, (row.name + ".auto").c_str());
  }
  draw_input_fault(workspace, row.name.c_str());
  ImGui::PopID();
}

/// Row for a number stored as int.
void log_row(Workspace& workspace, int& value, const LogRow& row) {
  std::int64_t wide = value;
  log_row(workspace, wide, row);
  value = static_cast<int>(wide);
}

/// The row of a whole-numbered setting, without "auto".
template <auto member>
LogRow row_of(const Field<member>& setting) {
  return {.name = "settings." + std::string(setting.name),
          .label = std::string(setting.label),
          .help = std::string(setting.help),
          .low = 1,
          .high = static_cast<std::int64_t>(setting.slider_high),
          .limit = static_cast<std::int64_t>(setting.high),
          .decides = is_physical(setting)};
}

/// A choice that is disabled, with the reason.
template <class Choice>
struct Unavailable {
  Choice choice;
  std::string why;  ///< reason; empty: enabled
};

/// A list of a setting's choices. The tooltip of the list or of an item is its help.
template <auto member, class Choice>
void choice_row(Workspace& workspace, const Field<member>& setting, Choice& value,
                const Unavailable<Choice>& unavailable_reason = {}) {
  const std::string name = "settings." + std::string(setting.name), help(setting.help);
  row_label(std::string(setting.label).c_str(), help.c_str());
  const std::string chosen(name_of(setting.choices, value));
  ImGui::PushID(name.c_str());
  const bool open = begin_choice("##choice", chosen.c_str());
  if (!open) explain(help.c_str());
  if (open) {
    for (const Named<Choice>& one : setting.choices) {
      const bool is_unavailable = one.value == unavailable_reason.choice && !unavailable_reason.why.empty();
      ImGui::BeginDisabled(is_unavailable);
      const std::string text(one.name),
          shown = is_unavailable ? fmt::format("{}: {}", text, unavailable_reason.why) : text;
      if (ImGui::Selectable(shown.c_str(), one.value == value)) value = one.value;
      if (!one.help.empty()) explain(std::string(one.help).c_str());
      ImGui::EndDisabled();
      track(workspace, (name + "." + text).c_str());
    }
    ImGui::EndCombo();
  }
  ImGui::PopID();
  track(workspace, name.c_str());
}

void draw_generator(Workspace& workspace, const WorkspaceView& view) {
  Settings& s = workspace.settings;
  if (!view.generated) {
    row_text("N", grouped_number(s.generator.count),
             "Number of bodies. It can be changed in scenes with one generator");
    return;
  }
  // Pairs of "paper" grow as N²: the slider stays within playable counts, the field accepts more.
  LogRow row = row_of(field_of<&BoxCollider::count>);
  if (s.generator.variant == Variant::paper) row.high = 20'000;
  log_row(workspace, s.generator.count, row);
  const std::string sum = bodies_text(view);
  if (sum.empty()) return;
  faint_text(sum);
  track(workspace, "settings.bodies.sum");
  explain("N counts the generated bodies. The others are listed in the scene or were added with B.");
}

void draw_shape(Workspace& workspace, const WorkspaceView& view) {
  Settings& s = workspace.settings;
  const LaunchRange chosen = launch_range(*view.history);
  LogRow blocks = row_of(field_of<&LaunchShape::blocks>), threads = row_of(field_of<&LaunchShape::threads>);
  blocks.chosen = &chosen.blocks;
  threads.chosen = &chosen.threads;
  blocks.manual = threads.manual = 256;
  log_row(workspace, s.run.shape.blocks, blocks);
  log_row(workspace, s.run.shape.threads, threads);
  const LaunchShape& shape = view.active_settings.run.shape;
  std::vector<std::string> lines = chosen.lines;
  if (shape.blocks > 0 && shape.threads > 0)
    lines.insert(lines.begin(), fmt::format("{} × {} = {} {}", grouped_number(shape.blocks), shape.threads,
                                            grouped_number(std::int64_t{shape.blocks} * shape.threads),
                                            view.executor == "CPU" ? "lanes" : "threads"));
  if (shape == LaunchShape{} && !view.tuned.empty()) {
    faint_text("auto uses a result of the Launch map");
    explain((view.tuned + ". --tuned off: plain auto").c_str());
  } else if (shape == LaunchShape{} && !view.tuned_rejection.empty()) {
    faint_text("auto uses no result of the Launch map");
    explain(("Reason: " + view.tuned_rejection).c_str());
  }
  for (const std::string& line : lines) {
    faint_text(line);
    explain(
        "Over all stages of the last step. The timing table explains each stage; for those marked * a "
        "library chooses a launch shape. B and T never change the result.");
  }
}

void draw_sweeps(Workspace& workspace, const WorkspaceView& view) {
  Settings& s = workspace.settings;
  const std::string chosen = std::to_string(view.substeps);
  LogRow row = row_of(field_of<&Physics::substeps>), iterations = row_of(field_of<&Physics::iterations>);
  row.column = iterations.column = 6.6f;
  row.field = iterations.field = 3.4f;
  row.chosen = &chosen;
  row.manual = view.substeps;
  int substeps = s.physics.substeps.value_or(0);
  log_row(workspace, substeps, row);
  if (view.substeps_missed > 0)
    ImGui::TextWrapped("%s", fmt::format("Joints call for {:.0f} substeps; auto gives at most {}.",
                                         view.substeps_missed, view.substeps)
                                 .c_str());
  s.physics.substeps = substeps > 0 ? std::optional(substeps) : std::nullopt;
  log_row(workspace, s.physics.iterations, iterations);
}

/// A row with a number field.
template <class Number>
void number_row(Workspace& workspace, const char* name, std::string_view label, std::string_view help,
                Number& value, const NumberRange<Number>& range, const char* format) {
  row_label(std::string(label).c_str(), std::string(help).c_str());
  ImGui::PushID(name);
  number_field(workspace, name, std::string(label).c_str(), value, range, format);
  ImGui::PopID();
  draw_input_fault(workspace, name);
}

/// One list per enumeration in a table of settings.
template <class Table, class Owner>
void choice_rows(Workspace& workspace, const WorkspaceView& view, const Table& table, Owner& owner) {
  for_each_field(
      table, [&]<auto member>(const Field<member>& setting) {
        const bool rotates = std::ranges::find(view.effects, "rotation") != view.effects.end();
        if (is_field<member, &Physics::rotation_update> && !rotates) return;
        if constexpr (std::is_enum_v<typename Field<member>::Value>)
          choice_row(workspace, setting, owner.*member);
      });
}

/// A slider from 0 to 1 with a number field.
void draw_restitution(Workspace& workspace, double& value) {
  constexpr auto& setting = field_of<&Material::restitution>;
  row_label("restitution", std::string(setting.help).c_str());
  ImGui::PushID("restitution");
  const float field = 3.4f * ImGui::GetFontSize(), gap = ImGui::GetStyle().ItemSpacing.x;
  ImGui::SetNextItemWidth(std::max(ImGui::GetContentRegionAvail().x - field - gap, field));
  float restitution = static_cast<float>(value);
  // The slider holds floats and 0.8 is no float: write back only if the slider moved.
  if (ImGui::SliderFloat("##slider", &restitution, 0, 1, "",
                         ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_NoInput))
    value = static_cast<double>(restitution);
  workspace.adjusting |= ImGui::IsItemActive();
  workspace.adjusting_result |= ImGui::IsItemActive();
  track(workspace, "settings.restitution");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(field);
  number_field(workspace, "settings.restitution.value", "restitution", value, {setting.low, setting.high},
               "{:.3g}");
  ImGui::PopID();
  draw_input_fault(workspace, "settings.restitution.value");
}

}  // namespace

std::string bodies_text(const WorkspaceView& view) {
  if (view.removed_bodies == 0 && view.other_bodies == 0) return "";
  std::string text = grouped_number(view.active_settings.generator.count) + " generated";
  if (view.removed_bodies > 0) text += fmt::format(" - {} removed", grouped_number(view.removed_bodies));
  if (view.other_bodies > 0) text += fmt::format(" + {} others", grouped_number(view.other_bodies));
  return text + " = " +
         grouped_number(view.active_settings.generator.count - view.removed_bodies + view.other_bodies);
}

void draw_settings_panel(Workspace& workspace, const WorkspaceView& view) {
  if (!begin_panel(workspace, "settings", "Simulation settings", workspace.visible_panels.settings))
    return end_panel();
  Settings& s = workspace.settings;
  draw_generator(workspace, view);
  draw_shape(workspace, view);

  choice_row(workspace, field_of<&ExecutorOptions::executor>, s.run.executor,
             {ExecutorKind::cuda, view.cuda_unavailable_reason});
  row_label("broad phase", "Algorithm that finds overlapping pairs; never changes the result");
  choose_broad_phase(workspace, view, "settings.broad_phase");
  if (!view.pairs_note.empty())
    choice_row(workspace, field_of<&ExecutorOptions::check_pairs>, s.run.check_pairs);

  ImGui::Spacing();
  faint_text("Physics (changes the result)");
  double rate = 1 / s.physics.time_step;
  const double before = rate;
  number_row(workspace, "settings.rate", field_of<&Physics::time_step>.label,
             "Steps per second of simulated time", rate,
             {limits::min_rate, limits::max_steps_per_second, "Hz"}, "{:.6g} Hz");
  if (rate != before) s.physics.time_step = 1 / rate;
  draw_restitution(workspace, s.material.restitution);
  choice_rows(workspace, view, physics_settings, s.physics);
  draw_sweeps(workspace, view);

  if (view.generated) {
    ImGui::Spacing();
    faint_text("Scene (restarts the run)");
    choice_rows(workspace, view, generator_settings, s.generator);
    number_row(workspace, "settings.radius", field_of<&BoxCollider::radius_max>.label,
               field_of<&BoxCollider::radius_max>.help, s.generator.radius_max,
               {limits::min_generated_radius, view.greatest_radius, "m"}, "{:.4g} m");
    number_row(workspace, "settings.seed", "seed", field_of<&BoxCollider::seed>.help, s.generator.seed,
               {0, std::numeric_limits<std::uint64_t>::max()}, "{}");
  }
  end_panel();
}

}  // namespace collidoscope

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/names.h"
#include "ui/launch_text.h"
#include "ui/number_field.h"
#include "ui/panels.h"
#include "ui/tree_widgets.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

// A whole number that can be typed, and a logarithmic slider of the same.
struct LogRow {
  const char *name, *label, *help;
  std::int64_t low, high, limit;        ///< the slider's ends, and the most that can be typed
  bool decides = true;                  ///< the result depends on it
  const std::string* chosen = nullptr;  ///< set: 0 is "auto", which has come to this, if it says so
  std::int64_t manual = 0;              ///< in its place, where "auto" is let go
  float column = 2, field = 5.4f;       ///< ems: where the slider begins, and what is typed into
};

void log_row(Workspace& workspace, std::int64_t& value, const LogRow& row) {
  ImGui::PushID(row.name);
  const float size = ImGui::GetFontSize();
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(row.label);
  explain(row.help);
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
  track(workspace, (std::string(row.name) + ".slider").c_str());
  ImGui::SameLine();
  ImGui::SetNextItemWidth(input);
  number_field(workspace, row.name, row.label, value,
               NumberRange<std::int64_t>{row.low, row.limit, "", automatic}, "{}");
  if (automatic) {
    ImGui::SameLine();
    if (is_auto) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
    if (ImGui::Button("auto", {button, 0})) value = is_auto ? row.manual : 0;
    if (is_auto) ImGui::PopStyleColor();
    track(workspace, (std::string(row.name) + ".auto").c_str());
  }
  draw_input_fault(workspace, row.name);
  ImGui::PopID();
}

/// The same of a number that is stored as an int.
void log_row(Workspace& workspace, int& value, const LogRow& row) {
  std::int64_t wide = value;
  log_row(workspace, wide, row);
  value = static_cast<int>(wide);
}

/// A choice that cannot be made is grey, with the reason beside it.
template <class Choice>
struct Unavailable {
  Choice choice;
  std::string why;  ///< empty: it can be made
};

template <class Choice, std::size_t count>
void choice_row(Workspace& workspace, const char* name, const char* label,
                const std::array<std::pair<Choice, const char*>, count>& choices, Choice& value,
                const char* help, const Unavailable<Choice>& unavailable_reason = {}) {
  row_label(label, help);
  const char* chosen = "?";
  for (const auto& [choice, text] : choices)
    if (choice == value) chosen = text;
  ImGui::PushID(name);
  if (begin_choice("##choice", chosen)) {
    for (const auto& [choice, text] : choices) {
      const bool is_unavailable = choice == unavailable_reason.choice && !unavailable_reason.why.empty();
      ImGui::BeginDisabled(is_unavailable);
      const std::string shown = is_unavailable ? fmt::format("{}: {}", text, unavailable_reason.why) : text;
      if (ImGui::Selectable(shown.c_str(), choice == value)) value = choice;
      ImGui::EndDisabled();
      track(workspace, (std::string(name) + "." + text).c_str());
    }
    ImGui::EndCombo();
  }
  ImGui::PopID();
  track(workspace, name);
}

void draw_generator(Workspace& workspace, const WorkspaceView& view) {
  Settings& s = workspace.settings;
  if (!view.generated) {
    row_text("N", grouped_number(s.bodies),
             "This scene lists its bodies; N turns where a scene has one generator");
    return;
  }
  // Pairs of "paper" grow as N²: what the slider reaches stays playable, more can be typed.
  const std::int64_t highest = s.variant == Variant::paper ? 20'000 : 2'000'000;
  log_row(workspace, s.bodies,
          {"settings.bodies", "N",
           "Bodies. Those that stay keep their state, unless the box goes with N (scaled, settled, equal): "
           "then the run starts again",
           1, highest, limits::max_bodies});
  const std::string sum = bodies_text(view);
  if (sum.empty()) return;
  faint_text(sum);
  track(workspace, "settings.bodies.sum");
  explain("N counts what the generator makes. The others are listed in the scene, or were thrown in with B.");
}

void draw_shape(Workspace& workspace, const WorkspaceView& view) {
  Settings& s = workspace.settings;
  const LaunchRange chosen = launch_range(*view.history);
  log_row(workspace, s.shape.blocks,
          {"settings.blocks", "B",
           "Blocks of a launch: exactly B · T threads (on the CPU: lanes) share each stage", 1, 65536,
           limits::max_blocks, false, &chosen.blocks, 256});
  log_row(workspace, s.shape.threads,
          {"settings.threads", "T", "Threads of a block, 1 to 1024", 1, limits::max_threads,
           limits::max_threads, false, &chosen.threads, 256});
  const LaunchShape& shape = view.active_settings.shape;
  std::vector<std::string> lines = chosen.lines;
  if (shape.blocks > 0 && shape.threads > 0)
    lines.insert(lines.begin(), fmt::format("{} × {} = {} {}", grouped_number(shape.blocks), shape.threads,
                                            grouped_number(std::int64_t{shape.blocks} * shape.threads),
                                            view.executor == "CPU" ? "lanes" : "threads"));
  for (const std::string& line : lines) {
    faint_text(line);
    explain(
        "Over all stages of the last step; the timing table explains each. A stage marked * there ignores "
        "(B, T) in part: a library launches it. Nothing here changes the result.");
  }
}

void draw_sweeps(Workspace& workspace, const WorkspaceView& view) {
  Settings& s = workspace.settings;
  const std::string chosen = std::to_string(view.substeps);
  LogRow row{"settings.substeps",
             "substeps",
             "Parts of a step, 1 to 1000. soft_step and jacobi_split find contacts once in a step and "
             "solve them in each part; impulse does all of it in each. auto: 1 with impulse, else 4, or "
             "as many as the joints call for",
             1,
             32,
             limits::max_substeps,
             true,
             &chosen,
             view.substeps,
             6.6f,
             3.4f};
  int substeps = s.substeps.value_or(0);
  log_row(workspace, substeps, row);
  s.substeps = substeps > 0 ? std::optional(substeps) : std::nullopt;
  row.name = "settings.iterations";
  row.label = "iterations";
  row.help = "Sweeps of the solver over all contacts, in each part of a step, 1 to 1000";
  row.limit = limits::max_iterations;
  row.chosen = nullptr;
  log_row(workspace, s.iterations, row);
}

void draw_motion(Workspace& workspace, const WorkspaceView& view) {
  static constexpr std::array<std::pair<Integrator, const char*>, 3> integrators{
      {{Integrator::semi_implicit_euler, "semi_implicit_euler"},
       {Integrator::velocity_verlet, "velocity_verlet"},
       {Integrator::rk4, "rk4"}}};
  choice_row(workspace, "settings.integrator", "integrator", integrators, workspace.settings.integrator,
             "How what meets nothing flies on: semi_implicit_euler, the paper's, to first order; "
             "velocity_verlet to second, rk4 to fourth. Whatever touches something moves as with the first");
  if (std::ranges::find(view.effects, "rotation") == view.effects.end()) return;
  static constexpr std::array<std::pair<RotationUpdate, const char*>, 2> updates{
      {{RotationUpdate::first_order, "first_order"}, {RotationUpdate::lie_group, "lie_group"}}};
  choice_row(workspace, "settings.rotation_update", "rotation", updates, workspace.settings.rotation_update,
             "How bodies turn: first_order, the paper's; lie_group to second order, or with rk4 to fourth, "
             "and without gaining or losing energy");
}

}  // namespace

std::string bodies_text(const WorkspaceView& view) {
  if (view.removed_bodies == 0 && view.other_bodies == 0) return "";
  std::string text = grouped_number(view.active_settings.bodies) + " generated";
  if (view.removed_bodies > 0) text += fmt::format(" - {} removed", grouped_number(view.removed_bodies));
  if (view.other_bodies > 0) text += fmt::format(" + {} others", grouped_number(view.other_bodies));
  return text + " = " + grouped_number(view.active_settings.bodies - view.removed_bodies + view.other_bodies);
}

void draw_settings_panel(Workspace& workspace, const WorkspaceView& view) {
  if (!begin_panel(workspace, "settings", "N · B · T", workspace.visible_panels.settings)) return end_panel();
  Settings& s = workspace.settings;
  draw_generator(workspace, view);
  draw_shape(workspace, view);

  std::array<std::pair<ExecutorKind, const char*>, 3> executors{
      {{ExecutorKind::automatic, "auto"}, {ExecutorKind::cpu, "cpu"}, {ExecutorKind::cuda, "cuda"}}};
  choice_row(workspace, "settings.executor", "executor", executors, s.executor,
             "What runs the stages; never changes the result",
             {ExecutorKind::cuda, view.cuda_unavailable_reason});
  row_label("broad phase", "How pairs are found; never changes the result");
  choose_broad_phase(workspace, view, "settings.broad_phase");

  ImGui::Spacing();
  faint_text("These change the result");
  row_label("rate", "Steps in a second of simulated time");
  ImGui::PushID("rate");
  double rate = 1 / s.time_step;
  if (number_field(workspace, "settings.rate", "rate", rate,
                   {limits::min_rate, limits::max_steps_per_second, "Hz"}, "{:.6g} Hz"))
    s.time_step = 1 / rate;
  ImGui::PopID();
  draw_input_fault(workspace, "settings.rate");
  row_label("restitution", "Of the material \"default\": 0 keeps nothing of a bounce, 1 all of it");
  ImGui::PushID("restitution");
  const float field = 3.4f * ImGui::GetFontSize(), gap = ImGui::GetStyle().ItemSpacing.x;
  ImGui::SetNextItemWidth(std::max(ImGui::GetContentRegionAvail().x - field - gap, field));
  float restitution = static_cast<float>(s.restitution);
  // The scene's 0.8 is not a float's: only what was moved is written back.
  if (ImGui::SliderFloat("##slider", &restitution, 0, 1, "",
                         ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_NoInput))
    s.restitution = static_cast<double>(restitution);
  workspace.adjusting |= ImGui::IsItemActive();
  workspace.adjusting_result |= ImGui::IsItemActive();
  track(workspace, "settings.restitution");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(field);
  number_field(workspace, "settings.restitution.value", "restitution", s.restitution,
               {0, limits::max_restitution}, "{:.3g}");
  ImGui::PopID();
  draw_input_fault(workspace, "settings.restitution.value");
  static constexpr std::array<std::pair<Precision, const char*>, 2> precisions{
      {{Precision::f32, "f32"}, {Precision::f64, "f64"}}};
  choice_row(workspace, "settings.precision", "precision", precisions, s.precision,
             "Of everything that is simulated");

  static constexpr std::array<std::pair<Solver, const char*>, 3> solvers{
      {{Solver::impulse, "impulse"},
       {Solver::soft_step, "soft_step"},
       {Solver::jacobi_split, "jacobi_split"}}};
  choice_row(workspace, "settings.solver", "solver", solvers, s.solver,
             "What contacts do. impulse: the paper's, which lets piles sink. soft_step: contacts are soft, "
             "steps go in substeps, and piles come to rest. jacobi_split: the same, but all contacts at once "
             "between parts of bodies");
  draw_sweeps(workspace, view);
  draw_motion(workspace, view);

  if (view.generated) {
    ImGui::Spacing();
    faint_text("These start the run again");
    static constexpr std::array<std::pair<Variant, const char*>, 4> variants{{{Variant::paper, "paper"},
                                                                              {Variant::scaled, "scaled"},
                                                                              {Variant::settled, "settled"},
                                                                              {Variant::equal, "equal"}}};
    choice_row(workspace, "settings.variant", "variant", variants, s.variant,
               "paper: the box stays 100 m wide, pairs grow as N². scaled: the box grows, 30 % full, pairs "
               "grow as N. "
               "settled: as scaled, at rest; made once for each N, which takes a while: this run goes on "
               "meanwhile, and Escape keeps it. "
               "equal: as scaled, with one radius");
    row_label("radius ≤", "Of the generated spheres");
    ImGui::PushID("radius");
    number_field(workspace, "settings.radius", "radius", s.radius_max,
                 {limits::min_generated_radius, view.greatest_radius, "m"}, "{:.4g} m");
    ImGui::PopID();
    draw_input_fault(workspace, "settings.radius");
    row_label("seed", "Of all that is random at the start");
    ImGui::PushID("seed");
    number_field(workspace, "settings.seed", "seed", s.seed,
                 NumberRange<std::uint64_t>{0, std::numeric_limits<std::uint64_t>::max()}, "{}");
    ImGui::PopID();
    draw_input_fault(workspace, "settings.seed");
  }
  end_panel();
}

}  // namespace collidoscope

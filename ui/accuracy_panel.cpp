// Panel Accuracy: error versus cost of many settings of the running scene, measured while the panel is open.
// A click on a point applies its setting. The tolerance is a line across the diagram. The cheapest setting
// below it is recommended.

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/names.h"
#include "ui/accuracy_chart.h"
#include "ui/number_field.h"
#include "ui/panels.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

void wrapped_faint(const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
  ImGui::TextWrapped("%s", text.c_str());
  ImGui::PopStyleColor();
}

void request_settings(const AccuracySetting& setting, const AccuracyView& panel, Settings& settings) {
  apply(patch_of(setting), settings);
  settings.physics.effects = panel.effects;  // a fixed list: "auto" may depend on the time step
  settings.physics.effects->continuous_collision = setting.continuous_collision;
}

std::string count_text(int count, const char* one) {
  return fmt::format("{} {}{}", count, one, count == 1 ? "" : "s");
}

void accuracy_tooltip(const AccuracyPoint& p, const WorkspaceView& view, bool now) {
  const auto row = [](const char* name, const std::string& text) {
    ImGui::TextDisabled("%s", name);
    ImGui::SameLine(ImGui::GetFontSize() * 8.6f);
    ImGui::TextUnformatted(text.c_str());
  };
  const auto share = [&](const char* name, double value) {
    if (std::isfinite(value)) row(name, fmt::format("{:.2g}", value));
  };
  const auto length = [&](const char* name, double value) {
    if (std::isfinite(value)) row(name, length_text(value));
  };
  const AccuracySetting& s = p.setting;
  ImGui::BeginTooltip();
  ImGui::TextUnformatted((p.series_name + (now ? " · current setting" : "")).c_str());
  row("step rate", fmt::format("{:.6g} Hz, {}, {}", 1 / s.time_step, count_text(s.substeps, "substep"),
                               count_text(s.iterations, "iteration")));
  row("solver", std::string(name_of(solver_names, s.solver)));
  row("integrator", std::string(name_of(integrator_names, s.integrator)));
  row("rotation", std::string(name_of(rotation_update_names, s.rotation_update)));
  row("precision", std::string(name_of(precision_names, s.precision)) +
                       (s.continuous_collision ? ", continuous collision" : ""));
  ImGui::Separator();
  const auto spread = [](const std::string& low, const std::string& high) {
    return " (" + low + " to " + high + ")";
  };
  row("rms error", length_text(p.error) + (std::isfinite(p.error_low) && std::isfinite(p.error_high)
                                               ? spread(length_text(p.error_low), length_text(p.error_high))
                                               : ""));
  length("max error", p.error_worst);
  if (view.with_times)
    row("cost", fmt::format("{} ms/s", short_number(p.ms.median)) +
                    (std::isfinite(p.ms.low) && std::isfinite(p.ms.high)
                         ? spread(short_number(p.ms.low), short_number(p.ms.high))
                         : ""));
  const AccuracyInvariants& kept = p.invariants;
  share("energy drift", kept.energy_drift);
  share("momentum drift", kept.momentum_balance);
  share("ang. mom. drift", kept.angular_momentum_balance);
  length("max penetration", kept.penetration_max);
  length("joint error", kept.joint_error);
  share("cone violation", kept.cone_violation);
  length("heights W1", p.distributions.heights);
  if (std::isfinite(p.distributions.speeds))
    row("speeds W1", fmt::format("{} m/s", short_number(p.distributions.speeds)));
  ImGui::TextDisabled("%s", p.on_front ? "on the Pareto front; click to apply" : "click to apply");
  ImGui::EndTooltip();
}

void draw_progress(Workspace& workspace, const AccuracyView& panel) {
  const float size = ImGui::GetFontSize();
  const bool over = panel.current_task.empty();
  const char* const label = over ? "done" : workspace.accuracy.running ? "stop" : "resume";
  const float buttons = 9.9f * size;
  ImGui::PushStyleColor(ImGuiCol_PlotHistogram, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
  ImGui::ProgressBar(static_cast<float>(panel.done), {ImGui::GetContentRegionAvail().x - buttons, 0},
                     over ? "all measured" : fmt::format("{:.0f} %", std::floor(100 * panel.done)).c_str());
  ImGui::PopStyleColor();
  if (!over) explain(("measuring " + panel.current_task).c_str());
  ImGui::SameLine();
  ImGui::BeginDisabled(over);
  if (ImGui::Button(label, {3.8f * size, 0})) workspace.accuracy.running = !workspace.accuracy.running;
  ImGui::EndDisabled();
  track(workspace, "accuracy.running");
  ImGui::SameLine();
  if (ImGui::Button("restart", {-1, 0})) workspace.accuracy.restart = true;
  track(workspace, "accuracy.restart");
  explain("Restarts the reference and all measurements from the present state");
}

void draw_diagram(Workspace& workspace, const AccuracyView& panel, const WorkspaceView& view) {
  const bool light = workspace.theme == Theme::light;
  AccuracyChart diagram = accuracy_chart(panel.points, panel.reference, workspace.accuracy.tolerance, light);
  diagram.chart.names = diagram.chart.has_tooltip = false;
  double least = 1e300, most = 0;
  for (std::size_t s = 0; s < diagram.points.size(); ++s)
    for (std::size_t k = 0; k < diagram.points[s].size(); ++k) {
      const AccuracyPoint& p = panel.points[diagram.points[s][k]];
      ChartPoint& place = diagram.chart.series[s].points[k];
      if (panel.cheapest == diagram.points[s][k]) place.ring = ImGui::GetColorU32(ImGuiCol_CheckMark);
      if (p.setting == panel.now) place.ring = ImGui::GetColorU32(ImGuiCol_Text);
      if (p.error > 0) least = std::min(least, p.error);
      most = std::max(most, p.error);
    }
  const ChartHit hit =
      draw_chart("diagram", ImGui::GetContentRegionAvail().x, ImGui::GetFontSize() * 21, diagram.chart);
  const bool clicked = ImGui::IsItemClicked(), held = ImGui::IsItemActive();
  track(workspace, "accuracy.diagram");

  // The drag continues on the element on which the button was pressed.
  ImGuiStorage* const memory = ImGui::GetStateStorage();
  const ImGuiID dragging = ImGui::GetID("tolerance is dragged");
  if (clicked) memory->SetBool(dragging, hit.level);
  if (held && memory->GetBool(dragging) && most > 0)
    workspace.accuracy.tolerance = std::clamp(hit.y, 0.1 * least, 10 * most);
  if (hit.level || (held && memory->GetBool(dragging))) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeNS);
  AccuracyRequests& requests = workspace.accuracy;
  requests.line.reset();
  if (hit.level_at > 0) requests.line = {0, hit.right - 0.25f * ImGui::GetFontSize(), hit.level_at};
  requests.places.clear();
  for (const ChartHit::Place& place : hit.places)
    if (place.series > 0)  // points of the front belong to other series
      requests.places.push_back(
          {diagram.points[static_cast<std::size_t>(place.series)][static_cast<std::size_t>(place.point)],
           place.x, place.y});
  if (hit.point >= 0) {
    const AccuracyPoint& p =
        panel.points[diagram
                         .points[static_cast<std::size_t>(hit.series)][static_cast<std::size_t>(hit.point)]];
    accuracy_tooltip(p, view, p.setting == panel.now);
    if (clicked) request_settings(p.setting, panel, workspace.settings);
  }
  for (std::size_t k = 0; k < diagram.kinds.size(); ++k) {
    const auto& [name, color] = diagram.kinds[k];
    const float width = ImGui::CalcTextSize(name.c_str()).x;
    if (k > 0) {
      ImGui::SameLine();
      if (ImGui::GetContentRegionAvail().x < width) ImGui::NewLine();
    }
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(color), "%s", name.c_str());
  }
  faint_text("solid: f32, dashed: f64, wide: Pareto front");
}

void draw_answer(Workspace& workspace, const AccuracyView& panel, const WorkspaceView& view) {
  row_label("tolerance", "Largest acceptable error, m: drag the line, or type it");
  ImGui::PushID("tolerance");
  number_field(workspace, "accuracy.tolerance", "tolerance", workspace.accuracy.tolerance,
               {limits::min_tolerance, limits::max_tolerance, "m"}, "{:.3g} m");
  ImGui::PopID();
  draw_input_fault(workspace, "accuracy.tolerance");
  if (!panel.cheapest) {
    wrapped_faint(panel.no_recommendation_reason);
    return;
  }
  const AccuracyPoint& p = panel.points[*panel.cheapest];
  if (ImGui::Button("apply")) request_settings(p.setting, panel, workspace.settings);
  track(workspace, "accuracy.apply");
  explain("Applies the cheapest setting within the tolerance");
  ImGui::SameLine();
  ImGui::TextUnformatted(p.series_name.c_str());
  ImGui::TextUnformatted(fmt::format("{}: {}{}", p.name, length_text(p.error),
                                     view.with_times ? fmt::format(", {} ms", short_number(p.ms.median)) : "")
                             .c_str());
}

void draw_notes(const AccuracyView& panel) {
  if (panel.reference) {
    const AccuracyReference& r = *panel.reference;
    wrapped_faint(r.description);
    wrapped_faint(fmt::format("From state {}. Positions are compared over {:.3g} s{}",
                              grouped_number(panel.start_state), r.horizon,
                              r.end.empty() ? "." : ": " + r.end));
  } else {
    wrapped_faint(fmt::format("From state {}: computing the reference.", grouped_number(panel.start_state)));
  }
  for (const std::string& warning : panel.warnings) wrapped_faint("! " + warning);
}

}  // namespace

void draw_accuracy_panel(Workspace& workspace, const WorkspaceView& view) {
  if (!begin_panel(workspace, "accuracy", "Accuracy", workspace.visible_panels.accuracy)) return end_panel();
  if (view.accuracy == nullptr || !view.accuracy->unavailable_reason.empty()) {
    wrapped_faint(view.accuracy == nullptr ? "available after the next frame"
                                           : view.accuracy->unavailable_reason);
    return end_panel();
  }
  const AccuracyView& panel = *view.accuracy;
  draw_progress(workspace, panel);
  if (std::ranges::any_of(panel.points,
                          [](const AccuracyPoint& p) { return p.has_error() && p.has_cost(); })) {
    draw_diagram(workspace, panel, view);
    draw_answer(workspace, panel, view);
  }
  draw_notes(panel);
  end_panel();
}

}  // namespace collidoscope

// Panel Convergence: residual of the contacts after each solver iteration of the last step (root mean square,
// sim_cuda/solver/residual.h), on a logarithmic axis. Recorded only while the panel is open.

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "ui/panels.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

/// Decades of the axis: all positive values, at least three and at most twelve. Smaller values lie at the
/// bottom.
struct Decades {
  int low = -3, high = 0;
  explicit Decades(const std::vector<Residual>& residuals) {
    double least = 1e300, most = 0;
    for (const Residual& r : residuals) {
      most = std::max(most, r.rms);
      if (r.rms > 0) least = std::min(least, r.rms);
    }
    if (!(most > 0) || !std::isfinite(most)) return;
    high = static_cast<int>(std::ceil(std::log10(most)));
    low = std::clamp(static_cast<int>(std::floor(std::log10(least))), high - 12, high - 3);
  }
  /// Position on the axis: 0 at the bottom, 1 at the top.
  float place(double value) const {
    const double at = value > 0 ? (std::log10(value) - low) / (high - low) : 0;
    return static_cast<float>(std::clamp(at, 0.0, 1.0));
  }
};

void residual_tooltip(const Residual& r) {
  ImGui::BeginTooltip();
  ImGui::TextUnformatted(
      (fmt::format("substep {}, {}", r.substep + 1, r.stage) +
       (r.iteration == 0 ? ": before the first iteration" : fmt::format(": after iteration {}", r.iteration)))
          .c_str());
  ImGui::TextUnformatted(
      fmt::format("rms {}, max {}", with_prefix(r.rms, "m/s"), with_prefix(r.max, "m/s")).c_str());
  ImGui::TextUnformatted((grouped_number(r.contacts) + " contacts, including walls").c_str());
  ImGui::EndTooltip();
}

void plot(const std::vector<Residual>& residuals, float width, float height, bool light) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImGui::InvisibleButton("residuals", {std::max(width, 1.0f), height});
  const bool hovered = ImGui::IsItemHovered();
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled(at, {at.x + width, at.y + height}, ImGui::GetColorU32(ImGuiCol_FrameBg, 0.55f), 3);
  const float size = ImGui::GetTextLineHeight(), pad = 0.5f * size;
  const Decades decades(residuals);
  const float left = at.x + pad + ImGui::CalcTextSize("100 mm/s").x + 0.5f * pad, right = at.x + width - pad,
              top = at.y + pad, bottom = at.y + height - pad;
  const ImU32 faint = ImGui::GetColorU32(ImGuiCol_TextDisabled),
              grid = ImGui::GetColorU32(ImGuiCol_TextDisabled, 0.22f);
  const int every = decades.high - decades.low > 5 ? 2 : 1;
  for (int exponent = decades.low; exponent <= decades.high; ++exponent) {
    const float y = bottom - (bottom - top) * decades.place(std::pow(10.0, exponent));
    list->AddLine({left, y}, {right, y}, grid);
    if ((decades.high - exponent) % every == 0)
      list->AddText({at.x + pad, y - 0.5f * size}, faint,
                    with_prefix(std::pow(10.0, exponent), "m/s").c_str());
  }
  const auto count = static_cast<float>(std::max<std::size_t>(residuals.size(), 2) - 1);
  const auto point = [&](std::size_t k) {
    return ImVec2{left + (right - left) * static_cast<float>(k) / count,
                  bottom - (bottom - top) * decades.place(residuals[k].rms)};
  };
  const float dot = std::max(1.5f, 0.14f * size);
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    const ImU32 color = stage_color(residuals[k].stage == "solve" ? 0 : 3, light);
    if (residuals[k].iteration > 0) list->AddLine(point(k - 1), point(k), color, std::max(1.0f, size / 10));
    if (residuals[k].iteration > 0)
      list->AddCircleFilled(point(k), dot, color, 12);
    else  // residual before the first iteration
      list->AddCircle(point(k), dot, color, 12);
    if (k > 0 && residuals[k].substep != residuals[k - 1].substep) {
      const float x = 0.5f * (point(k - 1).x + point(k).x);
      list->AddLine({x, top}, {x, bottom}, grid);
    }
  }
  if (!hovered) return;
  const float share = (ImGui::GetIO().MousePos.x - left) / std::max(right - left, 1.0f);
  const auto k = static_cast<std::size_t>(std::clamp(std::round(share * count), 0.0f, count));
  if (k >= residuals.size()) return;
  list->AddLine({point(k).x, top}, {point(k).x, bottom}, faint);
  residual_tooltip(residuals[k]);
}

void draw_key(bool light, bool relaxes) {
  const auto name = [&](const char* text, std::size_t color) {
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(stage_color(color, light)), "%s", text);
    ImGui::SameLine();
  };
  name("solve", 0);
  if (relaxes) name("relax", 3);
  faint_text("o before the first iteration");
  explain(
      "Residual: root mean square, over contacts with an impulse, of the velocity error that remains, m/s. "
      "Without softness it is |min(w, impulse / mass)|, the natural residual of the contact problem");
}

}  // namespace

void draw_convergence_panel(Workspace& workspace, const WorkspaceView& view) {
  if (!begin_panel(workspace, "convergence", "Convergence", workspace.visible_panels.convergence))
    return end_panel();
  const bool light = workspace.theme == Theme::light;
  if (view.residuals.empty()) {
    faint_text("available after the next step");
  } else {
    plot(view.residuals, ImGui::GetContentRegionAvail().x, ImGui::GetFontSize() * 9, light);
    track(workspace, "convergence.plot");
    draw_key(light, view.residuals.back().stage != "solve");
    const Residual& last = view.residuals.back();
    row_text("residual", with_prefix(last.rms, "m/s") + " rms, " + with_prefix(last.max, "m/s") + " max",
             "After the last iteration of the last step");
  }
  end_panel();
}

}  // namespace collidoscope

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ui/tree_sections.h"
#include "ui/tree_widgets.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

ImU32 color_of(const Legend& key, float value) {
  if (key.colors.empty()) return 0xffa0a0a0u;
  const auto place = [&](double v) { return key.logarithmic ? std::log(std::max(v, 1e-30)) : v; };
  const double from = place(key.min), width = place(key.max) - from;
  const double at = width > 0 ? std::clamp((place(static_cast<double>(value)) - from) / width, 0.0, 1.0) : 0;
  return key.colors[static_cast<std::size_t>(at * static_cast<double>(key.colors.size() - 1))];
}

}  // namespace

void draw_tree_histogram(Workspace& workspace, const WorkspaceView& view) {
  const NodeHistogram& histogram = view.tree->histogram;
  FrameLayers& layers = workspace.layers;
  constexpr int bins = static_cast<int>(NodeHistogram::bins);
  if (histogram.count == 0) {
    faint_text(layers.box_color == NodeMetric::level ? "Colour by a metric to see its distribution"
                                                     : "no values on these levels");
    return;
  }
  int first = 0, last = bins - 1;
  while (first + 1 < bins && histogram.edge[static_cast<std::size_t>(first) + 1] <= layers.box_low) ++first;
  while (last > first && histogram.edge[static_cast<std::size_t>(last)] > layers.box_high) --last;
  const float width = ImGui::GetContentRegionAvail().x, height = 3.2f * ImGui::GetFontSize();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  if (drag_ends("spread", width, height, bins, first, last)) {
    // At its extreme position an end has no limit, so that it stays at the extreme in later states.
    layers.box_low = first == 0 ? 0 : histogram.edge[static_cast<std::size_t>(first)];
    layers.box_high = last == bins - 1
                          ? std::numeric_limits<float>::infinity()
                          : std::nextafter(histogram.edge[static_cast<std::size_t>(last) + 1], 0.0f);
  }
  track(workspace, "tree.spread");
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const float cell = width / bins;
  if (ImGui::IsItemHovered()) {
    const auto bin =
        static_cast<std::size_t>(std::clamp(static_cast<int>((mouse.x - at.x) / cell), 0, bins - 1));
    explain(fmt::format("{:.4g} to {:.4g}: {} boxes. Drag an end: boxes outside the range are not drawn",
                        histogram.edge[bin], histogram.edge[bin + 1], grouped_number(histogram.nodes[bin]))
                .c_str());
  }
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled(at, {at.x + width, at.y + height}, ImGui::GetColorU32(ImGuiCol_FrameBg, 0.55f), 3);
  const std::int64_t most = *std::ranges::max_element(histogram.nodes);
  for (int bin = 0; bin < bins; ++bin) {
    const std::int64_t nodes = histogram.nodes[static_cast<std::size_t>(bin)];
    if (nodes == 0) continue;
    const float x = at.x + cell * static_cast<float>(bin);
    const float share = std::sqrt(static_cast<float>(nodes) / static_cast<float>(most));
    const bool on = bin >= first && bin <= last;
    ImU32 color =
        color_of(view.box_colors, histogram.edge[static_cast<std::size_t>(bin) + (2 * bin > bins ? 1 : 0)]);
    if (!on) color = (color & 0x00ffffffu) | 0x38000000u;
    list->AddRectFilled({x + 0.5f, at.y + height - std::max(share * (height - 2), 1.5f)},
                        {x + cell - 0.5f, at.y + height}, color);
  }
  const ImU32 handle = ImGui::GetColorU32(ImGuiCol_Text);
  for (const float x : {at.x + cell * static_cast<float>(first), at.x + cell * static_cast<float>(last + 1)})
    list->AddRectFilled({x - 2, at.y - 2}, {x + 2, at.y + height + 2}, handle, 2);

  faint_text(fmt::format("{:.4g} to {:.4g}{} · {} of {}", std::max(layers.box_low, histogram.least),
                         std::min(layers.box_high, histogram.greatest),
                         is_logarithmic(layers.box_color) ? ", log" : "", grouped_number(histogram.inside),
                         grouped_number(histogram.count)));
  explain(
      "Range of drawn values, and number of boxes of these levels within it. Bar height: square root of the "
      "number of boxes");
  const float button = ImGui::CalcTextSize("auto").x + 2 * ImGui::GetStyle().FramePadding.x;
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - button);
  const bool automatic = layers.box_low == 0 && std::isinf(layers.box_high);
  if (automatic) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
  if (ImGui::SmallButton("auto")) {
    layers.box_low = 0;
    layers.box_high = std::numeric_limits<float>::infinity();
  }
  if (automatic) ImGui::PopStyleColor();
  track(workspace, "tree.auto");
  explain("No limits: draws boxes of all values");
}

}  // namespace collidoscope

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ui/panels.h"
#include "ui/plot.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

constexpr float none = std::numeric_limits<float>::quiet_NaN();

template <class Value>
std::vector<float> over_time(const History& history, std::size_t first, Value value) {
  std::vector<float> values;
  for (std::size_t i = first; i < history.size(); ++i)
    values.push_back(history[i].measured ? static_cast<float>(value(history[i])) : none);
  return values;
}

int draw_stages(Workspace& workspace, const WorkspaceView& view, std::size_t first, float width,
                float height) {
  const History& history = *view.history;
  const bool light = workspace.theme == Theme::light;
  StackedBars bars;
  for (std::size_t i = first; view.with_times && i < history.size(); ++i) {
    bars.parts.push_back(history[i].stage_ms);
    bars.line.push_back(history[i].plain_ms < 0 ? none : static_cast<float>(history[i].plain_ms));
  }
  for (std::size_t k = 0; k < history.stages().size(); ++k) {
    bars.names.push_back(history.stages()[k].name);
    bars.colors.push_back(stage_color(k, light));
  }
  bars.marks = {{1000.0f / 60, "60 Hz"}, {1000.0f / 30, "30 Hz"}};
  bars.highlighted = workspace.hovered_stage;
  if (first < history.size()) bars.first_step = history[first].step;
  const int under = plot_stacked("stages", width, height, bars);
  track(workspace, "graph.stages");
  return under;
}

}  // namespace

void draw_graphs_panel(Workspace& workspace, const WorkspaceView& view) {
  const History& history = *view.history;
  const bool light = workspace.theme == Theme::light;
  const std::size_t first =
      history.size() - std::min(static_cast<std::size_t>(std::max(workspace.window, 1)), history.size());
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const float gap = ImGui::GetStyle().ItemSpacing.x;
  const float height = room.y, wide = std::round(0.42f * (room.x - 2 * gap)),
              narrow = std::round(0.29f * (room.x - 2 * gap));

  const int under = draw_stages(workspace, view, first, wide, height);
  // Whoever is pointed at, here or in the table; kept for the next frame's table and graph.
  workspace.hovered_stage = under;

  const std::int64_t first_step = first < history.size() ? history[first].step : 0;
  PlotFrame counts{"counts", [](double v) { return grouped_number(static_cast<std::int64_t>(v)); },
                   first_step, true};
  ImGui::SameLine();
  plot_lines("counts", narrow, height, counts,
             {{"pairs", stage_color(1, light),
               over_time(history, first, [](const HistoryStep& s) { return s.stats.pairs; })},
              {"contacts", stage_color(3, light),
               over_time(history, first, [](const HistoryStep& s) { return s.stats.contacts; })},
              {"boxes", stage_color(2, light),
               over_time(history, first, [](const HistoryStep& s) { return s.nodes; })}});
  track(workspace, "graph.counts");
  PlotFrame energy{"energy", [](double v) { return with_prefix(v, "J"); }, first_step, true};
  ImGui::SameLine();
  plot_lines("energy", narrow, height, energy,
             {{"total", ImGui::GetColorU32(ImGuiCol_Text),
               over_time(history, first, [](const HistoryStep& s) { return s.stats.energy(); })},
              {"kinetic", stage_color(0, light),
               over_time(history, first, [](const HistoryStep& s) { return s.stats.kinetic_energy; })},
              {"potential", stage_color(4, light),
               over_time(history, first, [](const HistoryStep& s) { return s.stats.potential_energy; })}});
  track(workspace, "graph.energy");
}

}  // namespace collidoscope

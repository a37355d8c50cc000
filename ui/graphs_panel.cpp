#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "ui/panels.h"
#include "ui/plot.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

constexpr float none = std::numeric_limits<float>::quiet_NaN();

template <class Value>
std::vector<float> over_time(const History& history, std::size_t first, std::size_t end, Value value) {
  std::vector<float> values;
  for (std::size_t i = first; i < end; ++i) {
    const float measured = history[i].measured ? static_cast<float>(value(history[i])) : 0;
    values.push_back(!history[i].measured      ? none
                     : std::isfinite(measured) ? measured
                                               : std::numeric_limits<float>::infinity());
  }
  return values;
}

/// Goes to the state that was clicked in a graph.
void go_to_click(Workspace& workspace, const WorkspaceView& view, const std::optional<std::int64_t>& state) {
  if (!state || !view.timeline || *state == view.stats.step) return;
  if (*state >= view.timeline->first && *state <= view.timeline->last) workspace.request_state(*state);
}

int draw_stages(Workspace& workspace, const WorkspaceView& view, std::size_t first, std::size_t end,
                float width, float height) {
  const History& history = *view.history;
  const bool light = workspace.theme == Theme::light;
  StackedBars bars;
  for (std::size_t i = first; view.with_times && i < end; ++i) {
    bars.parts.push_back(history[i].stage_ms);
    bars.line.push_back(history[i].plain_ms < 0 ? none : static_cast<float>(history[i].plain_ms));
  }
  for (std::size_t k = 0; k < history.stages().size(); ++k) {
    bars.names.push_back(history.stages()[k].name);
    bars.colors.push_back(stage_color(k, light));
  }
  bars.marks = {{1000.0f / 60, "60 Hz"}, {1000.0f / 30, "30 Hz"}};
  bars.highlighted = workspace.hovered_stage >= 0 ? workspace.hovered_stage : workspace.chosen_stage;
  if (first < history.size()) bars.first_step = history[first].step;
  bars.shown_step = view.stats.step;
  if (!view.with_times) bars.note = "not shown: times differ between runs";
  const StackedUnder under = plot_stacked("stages", width, height, bars);
  track(workspace, "graph.stages");
  go_to_click(workspace, view, under.click);
  return under.part;
}

}  // namespace

void draw_graphs_panel(Workspace& workspace, const WorkspaceView& view) {
  const History& history = *view.history;
  const bool light = workspace.theme == Theme::light;
  const std::size_t window =
      std::min(static_cast<std::size_t>(std::max(workspace.window, 1)), history.size());
  std::size_t first = history.size() - window;
  // At an earlier state, it is in the middle.
  if (first > 0 && view.stats.step < history[first].step) {
    const std::int64_t before = history[first].step - view.stats.step + static_cast<std::int64_t>(window / 2);
    first -= std::min(first, static_cast<std::size_t>(before));
  }
  const std::size_t end = std::min(first + window, history.size());
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const float gap = std::round(ImGui::GetStyle().ItemSpacing.x);
  const float wide = std::round(0.44f * (room.x - gap)), narrow = room.x - gap - wide;

  const int under = draw_stages(workspace, view, first, end, wide, room.y);
  // Stage under the pointer in graph or table, used by both in the next frame.
  workspace.hovered_stage = under;

  // Time series below each other, with a common time axis.
  const float space = std::round(0.6f * ImGui::GetStyle().ItemSpacing.y);
  const float height = std::floor((room.y - 2 * space) / 3);
  const std::int64_t first_step = first < history.size() ? history[first].step : 0;
  const ImU32 text = ImGui::GetColorU32(ImGuiCol_Text);
  ImGui::SameLine(0, gap);
  ImGui::BeginGroup();
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {gap, space});
  PlotFrame counts{"counts", [](double v) { return grouped_number(static_cast<std::int64_t>(v)); },
                   first_step, true, view.stats.step};
  std::vector<PlotLine> lines{
      {"pairs", stage_color(1, light),
       over_time(history, first, end, [](const HistoryStep& s) { return s.stats.pairs; })},
      {"touching", stage_color(3, light),
       over_time(history, first, end, [](const HistoryStep& s) { return s.stats.touching; })},
      {"speculative", stage_color(4, light),
       over_time(history, first, end, [](const HistoryStep& s) { return s.stats.speculative; })},
      {"boxes", stage_color(2, light),
       over_time(history, first, end, [](const HistoryStep& s) { return s.nodes; })}};
  if (view.stats.can_sleep)
    lines.push_back({"asleep", stage_color(0, light),
                     over_time(history, first, end, [](const HistoryStep& s) { return s.stats.asleep; })});
  go_to_click(workspace, view, plot_lines("counts", narrow, height, counts, lines));
  track(workspace, "graph.counts");
  PlotFrame energy{"energy", [](double v) { return with_prefix(v, "J"); }, first_step, true, view.stats.step};
  go_to_click(
      workspace, view,
      plot_lines(
          "energy", narrow, height, energy,
          {{"total", text,
            over_time(history, first, end, [](const HistoryStep& s) { return s.stats.energy(); })},
           {"kinetic", stage_color(0, light),
            over_time(history, first, end, [](const HistoryStep& s) { return s.stats.kinetic_energy; })},
           {"potential", stage_color(4, light),
            over_time(history, first, end, [](const HistoryStep& s) { return s.stats.potential_energy; })}}));
  track(workspace, "graph.energy");
  PlotFrame momentum{"momentum", [](double v) { return fmt::format("{:.3g} kg m/s", v); }, first_step, true,
                     view.stats.step};
  const auto component = [&](std::size_t axis) {
    return over_time(history, first, end, [axis](const HistoryStep& s) { return s.stats.momentum[axis]; });
  };
  go_to_click(workspace, view,
              plot_lines("momentum", narrow, height, momentum,
                         {{"|p|", text,
                           over_time(history, first, end,
                                     [](const HistoryStep& s) {
                                       return std::hypot(s.stats.momentum[0], s.stats.momentum[1],
                                                         s.stats.momentum[2]);
                                     })},
                          {"x", stage_color(3, light), component(0)},
                          {"y", stage_color(2, light), component(1)},
                          {"z", stage_color(0, light), component(2)}}));
  track(workspace, "graph.momentum");
  ImGui::PopStyleVar();
  ImGui::EndGroup();
}

}  // namespace collidoscope

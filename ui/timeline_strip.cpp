// The strip over the graphs: the whole run, with lanes of values, marks, and a cursor at the shown state.

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "ui/panels.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

using TimelineView = WorkspaceView::TimelineView;

/// Place of the states in the strip.
struct StatesAxis {
  float left, width;  ///< pixels
  std::int64_t first, last;
  float x_of(double state) const {
    const double span = static_cast<double>(std::max<std::int64_t>(last - first, 1));
    return left + static_cast<float>((state - static_cast<double>(first)) / span) * width;
  }
  std::int64_t state_at(float x) const {
    const double share = std::clamp((x - left) / std::max(width, 1.0f), 0.0f, 1.0f);
    return first + std::llround(share * static_cast<double>(last - first));
  }
};

struct LaneStyle {
  RunLanes::Lane lane;
  const char* name;
  std::uint32_t color;
  bool from_zero;
  std::string (*text)(double);
};

ImU32 mark_color(TimelineMark::Kind kind) {
  switch (kind) {
    case TimelineMark::Kind::change:
      return IM_COL32(240, 170, 60, 255);
    case TimelineMark::Kind::condition:
      return IM_COL32(240, 90, 80, 255);
    case TimelineMark::Kind::violation:
      return IM_COL32(225, 80, 200, 255);
  }
  return 0;
}

/// The mark nearest to the pointer, within a few pixels.
const TimelineMark* mark_near(const TimelineView& timeline, const StatesAxis& axis, float x) {
  const float reach = 0.4f * ImGui::GetFontSize();
  const TimelineMark* nearest = nullptr;
  float least = reach;
  for (const TimelineMark& mark : timeline.marks) {
    const float away = std::abs(axis.x_of(static_cast<double>(mark.state)) - x);
    if (away > least) continue;
    least = away;
    nearest = &mark;
  }
  return nearest;
}

void draw_lane(const TimelineView& timeline, const StatesAxis& axis, const LaneStyle& style, float top,
               float bottom, bool with_values) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const RunLanes& lanes = timeline.lanes;
  RunLanes::Range all = lanes.total(style.lane);
  const float size = ImGui::GetFontSize();
  if (with_values && std::isfinite(all.low) && std::isfinite(all.high)) {
    if (style.from_zero) all.low = std::min(all.low, 0.0f);
    const float span = std::max(all.high - all.low, 1e-30f);
    const auto y_of = [&](float value) { return bottom - (value - all.low) / span * (bottom - top - 2) - 1; };
    for (std::size_t k = 0; k < lanes.items().size(); ++k) {
      const RunLanes::Range& range = lanes.items()[k][static_cast<std::size_t>(style.lane)];
      if (!std::isfinite(range.low) || !std::isfinite(range.high)) continue;
      const auto from =
          static_cast<double>(lanes.first() + static_cast<std::int64_t>(k) * lanes.states_per_item());
      if (from + static_cast<double>(lanes.states_per_item()) <= static_cast<double>(axis.first)) continue;
      const float x0 = std::max(axis.x_of(from - 0.5), axis.left);
      const float x1 = std::min(axis.x_of(from + static_cast<double>(lanes.states_per_item()) - 0.5),
                                axis.left + axis.width);
      const float y0 = y_of(range.high), y1 = y_of(style.from_zero ? all.low : range.low);
      const ImU32 color = (style.color & 0x00ffffffu) | (style.from_zero ? 0x90000000u : 0xff000000u);
      list->AddRectFilled({x0, y0}, {std::max(x1, x0 + 1), std::max(y1, y0 + 1)}, color);
    }
  }
  // The name is left of the lane.
  list->AddText(nullptr, 0, {axis.left - 5.2f * size, top + 0.5f * (bottom - top - size)},
                ImGui::GetColorU32(ImGuiCol_TextDisabled), style.name);
}

void draw_marks(const TimelineView& timeline, const StatesAxis& axis, float top, float bottom) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const float half = 0.25f * ImGui::GetFontSize();
  for (const TimelineMark& mark : timeline.marks) {
    const float x = axis.x_of(static_cast<double>(mark.state));
    list->AddLine({x, top}, {x, bottom}, (mark_color(mark.kind) & 0x00ffffffu) | 0x80000000u);
    list->AddTriangleFilled({x - half, top - 2 * half}, {x + half, top - 2 * half}, {x, top},
                            mark_color(mark.kind));
  }
}

void draw_tooltip(const TimelineView& timeline, std::int64_t state, const TimelineMark* mark,
                  std::span<const LaneStyle> styles) {
  ImGui::BeginTooltip();
  ImGui::TextUnformatted(fmt::format("state {}", grouped_number(state)).c_str());
  const RunLanes& lanes = timeline.lanes;
  const std::int64_t item = (state - lanes.first()) / lanes.states_per_item();
  if (item >= 0 && item < std::ssize(lanes.items()))
    for (const LaneStyle& style : styles) {
      const RunLanes::Range& range =
          lanes.items()[static_cast<std::size_t>(item)][static_cast<std::size_t>(style.lane)];
      if (!std::isfinite(range.low)) continue;
      const std::string low = style.text(static_cast<double>(range.low)),
                        high = style.text(static_cast<double>(range.high));
      ImGui::TextUnformatted(
          fmt::format("{}: {}", style.name, low == high ? low : low + " to " + high).c_str());
    }
  if (mark != nullptr) ImGui::TextUnformatted(mark->text.c_str());
  ImGui::EndTooltip();
}

/// The part of another run after the common states, and a button that opens it.
void draw_other_run(Workspace& workspace, const TimelineView& timeline, const StatesAxis& axis, float top,
                    float height) {
  if (!timeline.other) return;
  const auto& [fork, last] = *timeline.other;
  const float from = axis.x_of(static_cast<double>(fork)), to = axis.x_of(static_cast<double>(last));
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled({from, top + 0.35f * height}, {std::max(to, from + 2), top + 0.65f * height},
                      ImGui::GetColorU32(ImGuiCol_PlotHistogram, 0.5f), 2);
  ImGui::SetCursorScreenPos({axis.left, top});
  if (ImGui::InvisibleButton("##other run", {std::max(axis.width, 1.0f), height}))
    workspace.other_run_requested = true;
  track(workspace, "timeline.other");
  explain(fmt::format("The run before the branch: its states {} to {}. Click: exchanges the two runs",
                      grouped_number(fork + 1), grouped_number(last))
              .c_str());
  list->AddText(nullptr, 0, {axis.left - 5.2f * ImGui::GetFontSize(), top},
                ImGui::GetColorU32(ImGuiCol_TextDisabled), "other");
}

}  // namespace

float timeline_strip_height(float font_size) { return std::round(5.6f * font_size); }

void draw_timeline_strip(Workspace& workspace, const WorkspaceView& view) {
  const TimelineView& timeline = *view.timeline;
  const bool light = workspace.theme == Theme::light;
  const float size = ImGui::GetFontSize(), width = ImGui::GetContentRegionAvail().x;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float marks = 0.6f * size, other = timeline.other ? 0.9f * size : 0;
  const float height = timeline_strip_height(size) - ImGui::GetStyle().ItemSpacing.y;
  StatesAxis axis{at.x + 5.6f * size, width - 6.2f * size, timeline.first, timeline.last};
  if (timeline.other) axis.last = std::max(axis.last, timeline.other->last);

  const LaneStyle styles[] = {{RunLanes::energy, "energy", ImGui::GetColorU32(ImGuiCol_Text), false,
                               [](double v) { return with_prefix(v, "J"); }},
                              {RunLanes::contacts, "contacts", stage_color(3, light), true,
                               [](double v) { return grouped_number(static_cast<std::int64_t>(v)); }},
                              {RunLanes::step_ms, "step time", stage_color(0, light), true,
                               [](double v) { return short_time(v) + " ms"; }}};
  ImGui::InvisibleButton("##timeline", {std::max(width, 1.0f), std::max(height - other, 1.0f)});
  const bool active = ImGui::IsItemActive(), hovered = ImGui::IsItemHovered();
  track(workspace, "timeline.strip", {axis.left, at.y, axis.width, height - other});
  if (ImGui::IsItemClicked()) workspace.pressed = "timeline.strip";
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->PushClipRect(at, {at.x + width, at.y + height}, true);
  const float top = at.y + marks, lane = (height - other - marks) / 3;
  list->AddRectFilled({axis.left, top}, {axis.left + axis.width, at.y + height - other},
                      ImGui::GetColorU32(ImGuiCol_FrameBg, 0.55f), 3);
  for (std::size_t k = 0; k < 3; ++k)
    draw_lane(timeline, axis, styles[k], top + static_cast<float>(k) * lane + 1,
              top + static_cast<float>(k + 1) * lane - 1,
              view.with_times || styles[k].lane != RunLanes::step_ms);
  draw_marks(timeline, axis, top, at.y + height - other);
  const float x = axis.x_of(static_cast<double>(view.stats.step));
  list->AddRectFilled({x, top}, {axis.left + axis.width, at.y + height - other},
                      ImGui::GetColorU32(ImGuiCol_WindowBg, 0.55f));  // states after the shown one
  list->AddLine({x, at.y}, {x, at.y + height - other}, ImGui::GetColorU32(ImGuiCol_Text),
                std::max(size / 9, 1.0f));
  list->PopClipRect();

  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const TimelineMark* const mark = mark_near(timeline, axis, mouse.x);
  std::int64_t state = std::clamp(axis.state_at(mouse.x), timeline.first, timeline.last);
  if (mark != nullptr && mouse.y < top) state = mark->state;
  if (active && state != view.stats.step) workspace.request_state(state);
  if (hovered) draw_tooltip(timeline, state, mark, styles);
  if (timeline.other) {
    draw_other_run(workspace, timeline, axis, at.y + height - other, other);
    ImGui::SetCursorScreenPos({at.x, at.y + height + ImGui::GetStyle().ItemSpacing.y});
  }
}

}  // namespace collidoscope

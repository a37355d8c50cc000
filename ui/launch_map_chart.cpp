#include "ui/launch_map_chart.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "ui/widgets.h"

namespace collidoscope {
namespace {

bool can_be_applied(LaunchCell::State state) {
  return state != LaunchCell::State::infeasible && state != LaunchCell::State::wrong;
}

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr double slowest_shown = 4;  ///< end of the colour scale, in times of the fastest cell

std::uint32_t with_alpha(std::uint32_t color, double alpha) {
  return (color & 0x00ffffffu) | static_cast<std::uint32_t>(std::lround(255 * alpha)) << 24;
}

double log2_of(int value) { return std::log2(static_cast<double>(value)); }

/// Values of B or of T, on a logarithmic axis. `ticks`: values of the first map; the others are refinements.
struct Axis {
  std::vector<int> ticks;
  double first = 0, step = 1, length = 0;  ///< log2; `length` in steps
  bool is_tick(int value) const { return std::ranges::binary_search(ticks, value); }
  /// 0 to 1, along the axis.
  float at(double log2_value) const {
    return static_cast<float>(((log2_value - first) / step + 0.5) / length);
  }
};

Axis axis_of(const LaunchMapView& map, int LaunchShape::*value) {
  std::set<int> all;
  for (const LaunchCell& cell : map.cells) all.insert(cell.shape.*value);
  const auto cells_at = [&](int v) {
    return std::ranges::count_if(map.cells, [&](const LaunchCell& cell) { return cell.shape.*value == v; });
  };
  std::ptrdiff_t most = 0;
  for (const int v : all) most = std::max(most, cells_at(v));
  Axis axis;
  for (const int v : all)
    if (2 * cells_at(v) > most) axis.ticks.push_back(v);
  axis.first = log2_of(axis.ticks.front());
  if (axis.ticks.size() > 1) axis.step = log2_of(axis.ticks[1]) - axis.first;
  axis.length = (log2_of(axis.ticks.back()) - axis.first) / axis.step + 1;
  return axis;
}

/// Position on the colour scale: 1 is the fastest cell.
double speed_of(double ms, const LaunchMapTimes& shown) {
  if (!(shown.slowest > shown.fastest)) return 1;
  return std::clamp(1 - std::log(ms / shown.fastest) / std::log(shown.slowest / shown.fastest), 0.0, 1.0);
}

std::uint32_t color_at(double speed, const LaunchMapView& map) {
  if (map.colors.empty()) return ImGui::GetColorU32(ImGuiCol_PlotHistogram);
  return map
      .colors[static_cast<std::size_t>(std::lround(speed * static_cast<double>(map.colors.size() - 1)))];
}

void hatch(ImDrawList& draw, ImVec2 low, ImVec2 high, std::uint32_t color, float gap) {
  draw.PushClipRect(low, high, true);
  for (float x = low.x - (high.y - low.y); x < high.x; x += gap)
    draw.AddLine({x, high.y}, {x + high.y - low.y, low.y}, color);
  draw.PopClipRect();
}

void cell_tooltip(const LaunchMapView& map, const LaunchMapTimes& shown, std::size_t index, bool with_times) {
  const LaunchCell& cell = map.cells[index];
  ImGui::BeginTooltip();
  const std::int64_t lanes = std::int64_t{cell.shape.blocks} * cell.shape.threads;
  ImGui::TextUnformatted(
      fmt::format("B = {}, T = {}: B × T = {}", cell.shape.blocks, cell.shape.threads, grouped_number(lanes))
          .c_str());
  const double infinite = std::numeric_limits<double>::infinity();
  switch (cell.state) {
    case LaunchCell::State::waiting:
      ImGui::TextDisabled("not measured yet");
      break;
    case LaunchCell::State::infeasible:
      ImGui::TextDisabled("cannot be launched: %s", cell.reason.c_str());
      break;
    case LaunchCell::State::left_out:
      ImGui::TextDisabled("left out: %s", cell.reason.c_str());
      break;
    case LaunchCell::State::wrong:
      ImGui::TextUnformatted(("ERROR, another result: " + cell.reason).c_str());
      break;
    case LaunchCell::State::measured: {
      const RatioEstimate ratio = cell.estimate();
      if (with_times && std::isfinite(shown.ms[index]))
        ImGui::TextUnformatted(fmt::format("{} ms per {}", short_time(shown.ms[index]),
                                           shown.stage != nullptr ? shown.stage->name : "step")
                                   .c_str());
      ImGui::TextDisabled(
          "%s", fmt::format("step: {} of {}, {} pairs",
                            ratio.high < infinite
                                ? fmt::format("{:.3f} ({:.3f} to {:.3f})", ratio.ratio, ratio.low, ratio.high)
                                : fmt::format("{:.3f}", ratio.ratio),
                            short_time(map.reference_ms) + " ms", ratio.pairs)
                    .c_str());
      if (shown.stage != nullptr && shown.stage->occupancy[index] > 0)
        ImGui::TextDisabled("occupancy %.0f %%", 100 * shown.stage->occupancy[index]);
      std::vector<float> ratios(cell.ratios.begin(), cell.ratios.end());
      std::ranges::sort(ratios);
      if (ratios.size() > 2) {
        ImGui::TextDisabled("ratio of each pair, ascending: %.3f to %.3f",
                            static_cast<double>(ratios.front()), static_cast<double>(ratios.back()));
        ImGui::PlotLines("##ratios", ratios.data(), static_cast<int>(ratios.size()), 0, nullptr,
                         ratios.front(), ratios.back(),
                         {13 * ImGui::GetFontSize(), 3 * ImGui::GetFontSize()});
      }
      break;
    }
  }
  if (can_be_applied(cell.state)) ImGui::TextDisabled("click to apply");
  ImGui::EndTooltip();
}

class MapDrawing {
 public:
  MapDrawing(Workspace& workspace, const WorkspaceView& view, const LaunchMapView& map,
             const LaunchMapTimes& shown)
      : workspace_(workspace),
        view_(view),
        map_(map),
        shown_(shown),
        blocks_(axis_of(map, &LaunchShape::blocks)),
        threads_(axis_of(map, &LaunchShape::threads)),
        em_(ImGui::GetFontSize()) {}

  void draw() {
    const float width = ImGui::GetContentRegionAvail().x, left = 2.6f * em_, below = 2.2f * em_;
    const float row = 1.7f * em_, height = row * static_cast<float>(threads_.length);
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    low_ = {corner.x + left, corner.y};
    high_ = {corner.x + width, corner.y + height};
    ImGui::InvisibleButton("map", {width, height + below});
    clicked_ = ImGui::IsItemClicked();
    hovered_ = ImGui::IsItemHovered();
    track(workspace_, "launch_map.map");
    draw_axes();
    std::vector<std::size_t> order(map_.cells.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::ranges::stable_partition(order, [&](std::size_t k) { return !is_refined(map_.cells[k].shape); });
    std::optional<std::size_t> under_pointer;
    workspace_.launch_map.places.clear();
    for (const std::size_t k : order) {
      draw_cell(k);
      const auto [low, high] = rect_of(map_.cells[k].shape);
      workspace_.launch_map.places.push_back({k, (low.x + high.x) / 2, (low.y + high.y) / 2});
      const ImVec2 at = ImGui::GetIO().MousePos;
      if (hovered_ && at.x >= low.x && at.x < high.x && at.y >= low.y && at.y < high.y) under_pointer = k;
    }
    draw_contours();
    for (const std::size_t k : map_.plateau) ring(map_.cells[k].shape, 0xc0000000, 1);
    if (map_.chosen) ring(map_.cells[*map_.chosen].shape, ImGui::GetColorU32(ImGuiCol_CheckMark), 2);
    if (shown_.stage != nullptr && map_.reference == LaunchShape{})
      mark(shown_.stage->reference_shape, "auto");
    mark(map_.now, "now");
    if (!under_pointer) return;
    cell_tooltip(map_, shown_, *under_pointer, view_.with_times);
    const LaunchCell& cell = map_.cells[*under_pointer];
    if (clicked_ && can_be_applied(cell.state)) workspace_.settings.run.shape = cell.shape;
  }

 private:
  bool is_refined(LaunchShape shape) const {
    return !blocks_.is_tick(shape.blocks) || !threads_.is_tick(shape.threads);
  }
  ImVec2 place(double log2_blocks, double log2_threads) const {
    return {low_.x + blocks_.at(log2_blocks) * (high_.x - low_.x),
            high_.y - threads_.at(log2_threads) * (high_.y - low_.y)};
  }
  std::pair<ImVec2, ImVec2> rect_of(LaunchShape shape) const {
    const double b = log2_of(shape.blocks), t = log2_of(shape.threads);
    const double half = is_refined(shape) ? 0.24 : 0.5;
    const ImVec2 one = place(b - half * blocks_.step, t + half * threads_.step),
                 other = place(b + half * blocks_.step, t - half * threads_.step);
    return {{std::round(one.x) + 1, std::round(one.y) + 1}, {std::round(other.x), std::round(other.y)}};
  }
  void draw_axes() {
    ImDrawList& draw = *ImGui::GetWindowDrawList();
    const std::uint32_t faint = ImGui::GetColorU32(ImGuiCol_TextDisabled);
    for (const int t : threads_.ticks) {
      const std::string text = std::to_string(t);
      const ImVec2 size = ImGui::CalcTextSize(text.c_str());
      draw.AddText({low_.x - size.x - 0.3f * em_, place(blocks_.first, log2_of(t)).y - size.y / 2}, faint,
                   text.c_str());
    }
    float free_from = low_.x - 1;
    for (const int b : blocks_.ticks) {
      const std::string text = std::to_string(b);
      const float width = ImGui::CalcTextSize(text.c_str()).x;
      const float x = std::min(place(log2_of(b), threads_.first).x - width / 2, high_.x - width);
      if (x < free_from) continue;  // it would overlap the last one
      draw.AddText({x, high_.y + 0.1f * em_}, faint, text.c_str());
      free_from = x + width + 0.4f * em_;
    }
    draw.AddText({low_.x - 2.5f * em_, high_.y + 0.1f * em_}, faint, "T \\ B");
  }
  void draw_cell(std::size_t index) {
    ImDrawList& draw = *ImGui::GetWindowDrawList();
    const LaunchCell& cell = map_.cells[index];
    const auto [low, high] = rect_of(cell.shape);
    const std::uint32_t line = ImGui::GetColorU32(ImGuiCol_TextDisabled, 0.6f);
    if (is_refined(cell.shape))
      draw.AddRectFilled({low.x - 1, low.y - 1}, {high.x + 1, high.y + 1},
                         ImGui::GetColorU32(ImGuiCol_WindowBg));
    if (std::isfinite(shown_.ms[index]))
      draw.AddRectFilled(low, high, color_at(speed_of(shown_.ms[index], shown_), map_));
    else if (cell.state == LaunchCell::State::infeasible)
      hatch(draw, low, high, line, 0.4f * em_);
    else if (cell.state == LaunchCell::State::wrong)
      draw_error(draw, low, high);
    else if (cell.state == LaunchCell::State::left_out)
      draw.AddRectFilled(low, high, ImGui::GetColorU32(ImGuiCol_TextDisabled, 0.18f));
    if (!std::isfinite(shown_.ms[index])) draw.AddRect(low, high, with_alpha(line, 0.3));
  }
  void draw_error(ImDrawList& draw, ImVec2 low, ImVec2 high) const {
    constexpr std::uint32_t red = 0xff3b3bd6, white = 0xffffffff;
    draw.AddRectFilled(low, high, red);
    const float inset = 0.25f * (high.y - low.y);
    const ImVec2 middle{(low.x + high.x) / 2, (low.y + high.y) / 2};
    for (const float side : {-1.0f, 1.0f})
      draw.AddLine({middle.x - inset, middle.y - side * inset}, {middle.x + inset, middle.y + side * inset},
                   white, 2);
  }
  /// Lines of equal B * T, and between cells of a stage whose occupancy differs by a quarter.
  void draw_contours() {
    ImDrawList& draw = *ImGui::GetWindowDrawList();
    const std::uint32_t color = ImGui::GetColorU32(ImGuiCol_Text, 0.45f);
    draw.PushClipRect(low_, high_, true);
    const double least = blocks_.first + threads_.first,
                 most = log2_of(blocks_.ticks.back()) + log2_of(threads_.ticks.back());
    for (double sum = 4 * std::ceil(least / 4); sum <= most; sum += 4) {
      const ImVec2 from = place(blocks_.first - blocks_.step, sum - blocks_.first + blocks_.step);
      const double last = log2_of(blocks_.ticks.back()) + blocks_.step;
      draw.AddLine(from, place(last, sum - last), with_alpha(color, 0.3));
    }
    if (shown_.stage != nullptr)
      for (std::size_t k = 0; k < map_.cells.size(); ++k) {
        const LaunchShape shape = map_.cells[k].shape;
        const auto above = std::ranges::upper_bound(threads_.ticks, shape.threads);
        if (is_refined(shape) || above == threads_.ticks.end()) continue;
        const auto other =
            std::ranges::find(map_.cells, LaunchShape{shape.blocks, *above}, &LaunchCell::shape);
        if (other == map_.cells.end()) continue;
        const double here = shown_.stage->occupancy[k],
                     there = shown_.stage->occupancy[static_cast<std::size_t>(other - map_.cells.begin())];
        if (!(here > 0 && there > 0) || std::floor(4 * here) == std::floor(4 * there)) continue;
        const auto [low, high] = rect_of(shape);
        draw.AddLine({low.x, low.y}, {high.x, low.y}, color, 2);
      }
    draw.PopClipRect();
  }
  void ring(LaunchShape shape, std::uint32_t color, float width) const {
    const auto [low, high] = rect_of(shape);
    ImGui::GetWindowDrawList()->AddRect({low.x + 1, low.y + 1}, {high.x - 1, high.y - 1}, color, 0, 0, width);
  }
  /// A disc with a name, at a shape that need not be a cell.
  void mark(LaunchShape shape, const char* name) const {
    if (shape.blocks <= 0 || shape.threads <= 0) return;
    ImVec2 at = place(log2_of(shape.blocks), log2_of(shape.threads));
    at = {std::clamp(at.x, low_.x, high_.x), std::clamp(at.y, low_.y, high_.y)};
    ImDrawList& draw = *ImGui::GetWindowDrawList();
    draw.AddCircleFilled(at, 0.3f * em_, 0xffffffff);
    draw.AddCircle(at, 0.3f * em_, 0xff000000, 0, 1.5f);
    const ImVec2 size = ImGui::CalcTextSize(name);
    const ImVec2 text{std::min(at.x + 0.45f * em_, high_.x - size.x), at.y - size.y / 2};
    draw.AddRectFilled({text.x - 1, text.y}, {text.x + size.x + 1, text.y + size.y}, 0xa0000000);
    draw.AddText(text, 0xffffffff, name);
  }

  Workspace& workspace_;
  const WorkspaceView& view_;
  const LaunchMapView& map_;
  const LaunchMapTimes& shown_;
  const Axis blocks_, threads_;
  const float em_;
  ImVec2 low_{}, high_{};
  bool clicked_ = false, hovered_ = false;
};

}  // namespace

LaunchMapTimes launch_map_times(const LaunchMapView& map, const std::string& stage) {
  LaunchMapTimes shown;
  for (const LaunchMapView::Stage& one : map.stages)
    if (one.name == stage) shown.stage = &one;
  for (std::size_t k = 0; k < map.cells.size(); ++k) {
    const LaunchCell& cell = map.cells[k];
    double ms = unknown;
    if (cell.state == LaunchCell::State::measured && shown.stage != nullptr &&
        k < shown.stage->cell_ms.size())
      ms = shown.stage->cell_ms[k];
    else if (cell.state == LaunchCell::State::measured && shown.stage == nullptr && !cell.ratios.empty())
      ms = map.reference_ms * cell.estimate().ratio;
    shown.ms.push_back(ms);
    if (!std::isfinite(ms)) continue;
    shown.fastest = std::isfinite(shown.fastest) ? std::min(shown.fastest, ms) : ms;
    shown.slowest = std::isfinite(shown.slowest) ? std::max(shown.slowest, ms) : ms;
  }
  shown.slowest = std::min(shown.slowest, slowest_shown * shown.fastest);
  return shown;
}

void draw_launch_map(Workspace& workspace, const WorkspaceView& view, const LaunchMapView& map,
                     const LaunchMapTimes& shown) {
  MapDrawing(workspace, view, map, shown).draw();
}

void draw_launch_map_scale(const LaunchMapView& map, const LaunchMapTimes& shown, bool with_times) {
  const float em = ImGui::GetFontSize(), width = ImGui::GetContentRegionAvail().x;
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  constexpr int parts = 64;
  for (int k = 0; k < parts; ++k) {
    const float from = width * static_cast<float>(k) / parts, to = width * static_cast<float>(k + 1) / parts;
    draw.AddRectFilled({corner.x + from, corner.y}, {corner.x + to, corner.y + 0.5f * em},
                       color_at(1 - (k + 0.5) / parts, map));
  }
  ImGui::Dummy({width, 0.55f * em});
  if (!with_times) return faint_text("fast to slow");
  const bool cut = shown.slowest >= slowest_shown * shown.fastest;
  faint_text(short_time(shown.fastest) + " ms");
  const std::string last = (cut ? "≥ " : "") + short_time(shown.slowest) + " ms";
  ImGui::SameLine(ImGui::GetCursorPosX() + width - ImGui::CalcTextSize(last.c_str()).x);
  faint_text(last);
}

}  // namespace collidoscope

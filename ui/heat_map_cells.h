#pragma once
// Parts of a heat map: text, colours, cells and the ring. Free functions between ImGui::NewFrame() and
// Render(). Only for heat_map.cpp.

#include <imgui.h>

#include <string>

#include "ui/heat_map.h"

namespace collidoscope {

struct HeatText {
  ImFont* font = nullptr;
  float size = 0;
  ImVec2 extent(const std::string& text) const;
  /// `across`, `down`: share of the extent left of and above the point.
  void draw(ImDrawList* list, ImVec2 at, float across, float down, ImU32 color,
            const std::string& text) const;
};

/// Pixels.
struct HeatRect {
  float left = 0, top = 0, right = 0, bottom = 0;
  float width() const { return right - left; }
  float height() const { return bottom - top; }
  ImVec2 center() const { return {0.5f * (left + right), 0.5f * (top + bottom)}; }
  HeatRect inset(float by) const { return {left + by, top + by, right - by, bottom - by}; }
};

/// 0 at the low end of the colours, 1 at the high end.
double share_of_bar(const HeatMap& map, double value);

/// `line`: height of a line of text. `number`: null for a cell of the key, which has no text.
void draw_cell(ImDrawList* list, float line, const HeatMap& map, const HeatRect& box, const HeatCell& cell,
               const HeatText* number);
/// The gap around a small cell.
void fill_gap(ImDrawList* list, const HeatRect& box);
void draw_ring(ImDrawList* list, float line, ImVec2 at);

}  // namespace collidoscope

#include "ui/heat_map_cells.h"

#include <algorithm>
#include <cmath>

namespace collidoscope {
namespace {

constexpr ImU32 page_color = IM_COL32(255, 255, 255, 255), frame_color = IM_COL32(16, 18, 24, 255),
                omitted_color = IM_COL32(236, 238, 241, 255), empty_color = IM_COL32(212, 215, 220, 255),
                hatch_color = IM_COL32(150, 156, 166, 255), error_fill = IM_COL32(255, 226, 222, 255),
                error_line = IM_COL32(200, 32, 32, 255);

ImU32 heat_color(const HeatMap& map, double value) {
  const double last = static_cast<double>(map.colors.size() - 1);
  return map.colors[static_cast<std::size_t>(std::lround(share_of_bar(map, value) * last))];
}

/// Black or white, whichever has the higher contrast (WCAG relative luminance).
ImU32 ink_on(ImU32 color) {
  const auto linear = [&](int shift) {
    const double c = ((color >> shift) & 255u) / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  };
  const double luminance = 0.2126 * linear(IM_COL32_R_SHIFT) + 0.7152 * linear(IM_COL32_G_SHIFT) +
                           0.0722 * linear(IM_COL32_B_SHIFT);
  return luminance > 0.18 ? IM_COL32(0, 0, 0, 255) : IM_COL32(255, 255, 255, 255);
}

void fill_heat(ImDrawList* list, const HeatRect& box, ImU32 color) {
  list->AddRectFilled({box.left, box.top}, {box.right, box.bottom}, color, 3);
}
void outline_heat(ImDrawList* list, const HeatRect& box, ImU32 color, float thick) {
  list->AddRect({box.left, box.top}, {box.right, box.bottom}, color, 3, 0, thick);
}

}  // namespace

ImVec2 HeatText::extent(const std::string& text) const {
  return font->CalcTextSizeA(size, 1e9f, 0, text.c_str(), text.c_str() + text.size());
}

void HeatText::draw(ImDrawList* list, ImVec2 at, float across, float down, ImU32 color,
                    const std::string& text) const {
  const ImVec2 size_of = extent(text);
  list->AddText(font, size, {std::round(at.x - across * size_of.x), std::round(at.y - down * size_of.y)},
                color, text.c_str());
}

double share_of_bar(const HeatMap& map, double value) {
  return std::clamp(std::log(value / map.low) / std::log(map.high / map.low), 0.0, 1.0);
}

void draw_cell(ImDrawList* list, float line, const HeatMap& map, const HeatRect& box, const HeatCell& cell,
               const HeatText* number) {
  const float thick = std::max(1.5f, line / 12);
  switch (cell.kind) {
    case HeatCell::Kind::value: {
      const ImU32 color = heat_color(map, cell.value);
      fill_heat(list, box, color);
      if (number) number->draw(list, box.center(), 0.5f, 0.5f, ink_on(color), map.number(cell.value));
      break;
    }
    case HeatCell::Kind::hatched: {
      fill_heat(list, box, page_color);
      list->PushClipRect({box.left, box.top}, {box.right, box.bottom}, true);
      for (float x = box.left - box.height(); x < box.right; x += 0.42f * line)
        list->AddLine({x, box.bottom}, {x + box.height(), box.top}, hatch_color, thick);
      list->PopClipRect();
      outline_heat(list, box, hatch_color, 1);
      break;
    }
    case HeatCell::Kind::crossed: {
      fill_heat(list, box, error_fill);
      const ImVec2 at = box.center();
      const float arm = 0.28f * std::min(box.width(), box.height());
      for (const float side : {-1.0f, 1.0f})
        list->AddLine({at.x - arm, at.y - side * arm}, {at.x + arm, at.y + side * arm}, error_line,
                      2 * thick);
      outline_heat(list, box.inset(0.5f * thick), error_line, thick);
      break;
    }
    case HeatCell::Kind::dashed: {
      fill_heat(list, box, omitted_color);
      const float arm = std::min(0.35f * line, 0.25f * box.width());
      list->AddLine({box.center().x - arm, box.center().y}, {box.center().x + arm, box.center().y},
                    hatch_color, thick);
      break;
    }
    case HeatCell::Kind::empty:
      outline_heat(list, box, empty_color, 1);
      break;
  }
  if (cell.frame == HeatCell::Frame::thin) outline_heat(list, box.inset(thick), frame_color, thick);
  if (cell.frame == HeatCell::Frame::thick) {
    outline_heat(list, box.inset(-0.5f), page_color, 4 * thick);
    outline_heat(list, box.inset(1.2f * thick), frame_color, 2.6f * thick);
  }
}

void fill_gap(ImDrawList* list, const HeatRect& box) { fill_heat(list, box, page_color); }

void draw_ring(ImDrawList* list, float line, ImVec2 at) {
  const float r = 0.4f * line;
  list->AddCircleFilled(at, r + 1.5f, frame_color, 32);
  list->AddCircleFilled(at, r - 1, page_color, 32);
  list->AddCircleFilled(at, 0.45f * r, frame_color, 24);
}

}  // namespace collidoscope

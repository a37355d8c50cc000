#include "viewer/render/legend.h"

#include "viewer/render/colors.h"

namespace collidoscope {
namespace {

std::uint32_t packed(const Rgb& color) {
  const auto byte = [](float value) { return static_cast<std::uint32_t>(value * 255 + 0.5f); };
  return 0xff000000u | byte(color.b) << 16 | byte(color.g) << 8 | byte(color.r);
}

}  // namespace

std::vector<std::uint32_t> value_legend() {
  std::vector<std::uint32_t> colors;
  for (const Rgb& one : color_map()) colors.push_back(packed(one));
  return colors;
}

Legend body_legend(BodyColor color, const ValueRange& range, const StepStats& stats) {
  Legend legend;
  if (color == BodyColor::id) return legend;  // adjacent ids have different colours, without a scale
  const ColorMeaning meaning = color_meaning(color);
  legend.title = meaning.title;
  legend.unit = meaning.unit;
  legend.min = range.min;
  legend.max = range.max;
  legend.logarithmic = range.logarithmic;
  legend.clamped_above =
      color == BodyColor::speed ? stats.max_speed > range.max : color == BodyColor::contacts;
  legend.colors = value_legend();
  legend.clamped_below = color == BodyColor::error;
  if (color == BodyColor::sleep) {
    legend.low_word = "asleep";
    legend.high_word = "awake";
  }
  return legend;
}

Legend box_legend(NodeMetric metric, const ValueRange& range) {
  Legend legend;
  if (metric == NodeMetric::level || range.boxes == 0) return legend;
  const ColorMeaning meaning = color_meaning(metric);
  legend.title = meaning.title;
  legend.unit = meaning.unit;
  legend.min = range.box_min;
  legend.max = range.box_max;
  legend.logarithmic = is_logarithmic(metric);
  legend.clamped_below = range.boxes_below;
  for (const Rgb& one : heat_map()) legend.colors.push_back(packed(one));
  return legend;
}

std::vector<std::uint32_t> contact_legend() {
  std::vector<std::uint32_t> colors;
  for (int k = 0; k < 64; ++k) colors.push_back(packed(contact_color(k / 63.0)));
  return colors;
}

std::uint32_t ghost_legend() { return packed(ghost_color); }
std::uint32_t error_legend() { return packed(error_color); }

std::vector<std::uint32_t> mark_legend() {
  std::vector<std::uint32_t> colors;
  for (std::size_t k = 0; k < box_marks; ++k)
    colors.push_back(packed(mark_style(static_cast<BoxMark>(k)).color));
  return colors;
}

std::vector<std::uint32_t> level_legend(int first, int last) {
  std::vector<std::uint32_t> colors;
  for (int level = 0; level < max_levels; ++level) colors.push_back(packed(level_color(level, first, last)));
  return colors;
}

}  // namespace collidoscope

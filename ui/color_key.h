#pragma once
// What the colours of a picture mean, for whoever writes it beside them. Plain data.

#include <cstdint>
#include <string>
#include <vector>

namespace collidoscope {

struct ColorKey {
  std::string title, unit;  ///< no title: nothing to explain
  double min = 0, max = 1;
  bool goes_on = false;               ///< larger values are drawn as the greatest
  bool goes_below = false;            ///< smaller values are drawn as the least
  bool logarithmic = false;           ///< even steps of the logarithm
  std::vector<std::uint32_t> colors;  ///< from least to greatest, 0xAABBGGRR as ImGui has it
  std::string low_word, high_word;    ///< in place of the numbers at the ends
};

/// From anything that has the same members: the renderer's legend, which ui/ may not see.
template <class Legend>
ColorKey color_key(const Legend& legend) {
  return {legend.title,      legend.unit,        legend.min,    legend.max,      legend.goes_on,
          legend.goes_below, legend.logarithmic, legend.colors, legend.low_word, legend.high_word};
}

/// "speed · m/s", "visits · log".
std::string title_text(const ColorKey& key);
/// The ends: "0" and "≥ 38".
std::string low_text(const ColorKey& key);
std::string high_text(const ColorKey& key);

}  // namespace collidoscope

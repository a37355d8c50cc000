#pragma once
// Legend of the colours in a picture. Plain data; the renderer fills it, the panels draw it.

#include <cstdint>
#include <string>
#include <vector>

namespace collidoscope {

struct Legend {
  std::string title, unit;  ///< empty title: no legend
  double min = 0, max = 1;
  bool clamped_above = false;         ///< larger values have the colour of max
  bool clamped_below = false;         ///< smaller values have the colour of min
  bool logarithmic = false;           ///< logarithmic scale
  std::vector<std::uint32_t> colors;  ///< from min to max, 0xAABBGGRR
  std::string low_word, high_word;    ///< labels instead of min and max; empty: none
};

}  // namespace collidoscope

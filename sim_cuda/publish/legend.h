#pragma once
// What the colours of a picture mean. Plain data, for the renderer, which makes it, and for the panels, which
// draw it.

#include <cstdint>
#include <string>
#include <vector>

namespace collidoscope {

struct Legend {
  std::string title, unit;  ///< no title: nothing to explain
  double min = 0, max = 1;
  bool clamped_above = false;         ///< larger values are drawn as the greatest
  bool clamped_below = false;         ///< smaller values are drawn as the least
  bool logarithmic = false;           ///< even steps of the logarithm
  std::vector<std::uint32_t> colors;  ///< from least to greatest, 0xAABBGGRR
  std::string low_word, high_word;    ///< in place of min and max
};

}  // namespace collidoscope

#pragma once
// Small plots over ImDrawList: lines over time, and stacked bars. Free functions, between ImGui::NewFrame()
// and Render(); they keep nothing.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace collidoscope {

/// A value that is not there is NaN: the line is interrupted.
struct PlotLine {
  std::string name;
  std::uint32_t color = 0xffffffff;  ///< 0xAABBGGRR
  std::vector<float> values;         ///< oldest first; all lines of a plot are equally long
};

struct PlotFrame {
  std::string title;
  std::function<std::string(double)> number;  ///< how a value is written
  std::int64_t first_step = 0;                ///< of values[0], for the tooltip
  bool from_zero = true;                      ///< else the axis begins near the least value
};

/// In `width` x `height` pixels from the cursor on.
void plot_lines(const char* id, float width, float height, const PlotFrame& frame,
                const std::vector<PlotLine>& lines);

struct StackedBars {
  std::vector<std::vector<float>> parts;  ///< parts[i][k]: of bar i the part k; empty: no bar
  std::vector<std::string> names;         ///< of the parts
  std::vector<std::uint32_t> colors;
  std::vector<float>
      line;  ///< drawn over the bars, joined where there are values (NaN: none), one for each bar
  struct Mark {
    float value;
    std::string label;
  };
  std::vector<Mark> marks;  ///< lines across, drawn where the axis reaches them
  int highlighted = -1;     ///< this part is bright, the rest is faint
  std::int64_t first_step = 0;
  std::string note;  ///< in the middle, where there are no bars
};

/// Returns the part under the pointer, or -1.
int plot_stacked(const char* id, float width, float height, const StackedBars& bars);

/// The end of an axis from 0 for these values: it fits nine in ten of them, and all that are not much
/// greater.
float stacked_axis(std::vector<float> values);

}  // namespace collidoscope

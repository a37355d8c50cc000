#pragma once
// Small plots with ImDrawList: time series and stacked bars. Stateless free functions, between
// ImGui::NewFrame() and Render().

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace collidoscope {

/// The line connects the values before and after a NaN. An infinite value interrupts it.
struct PlotLine {
  std::string name;
  std::uint32_t color = 0xffffffff;  ///< 0xAABBGGRR
  std::vector<float> values;         ///< oldest first; same length for all lines of a plot
};

struct PlotFrame {
  std::string title;
  std::function<std::string(double)> number;  ///< formats a value
  std::int64_t first_step = 0;                ///< step of values[0], for the tooltip
  bool from_zero = true;                      ///< false: the axis starts near the least value
  std::int64_t shown_step = -1;               ///< marked by a line
};

/// Draws `width` x `height` pixels at the cursor. Returns the step that is clicked.
std::optional<std::int64_t> plot_lines(const char* id, float width, float height, const PlotFrame& frame,
                                       const std::vector<PlotLine>& lines);

struct StackedBars {
  std::vector<std::vector<float>> parts;  ///< parts[i][k]: part k of bar i; empty: no bar
  std::vector<std::string> names;         ///< names of the parts
  std::vector<std::uint32_t> colors;
  std::vector<float> line;  ///< one value per bar, drawn over the bars; NaN: none
  struct Mark {
    float value;
    std::string label;
  };
  std::vector<Mark> marks;  ///< horizontal lines, drawn if within the axis
  int highlighted = -1;     ///< index of the bright part; the others are faint; -1: all bright
  std::int64_t first_step = 0;
  std::int64_t shown_step = -1;  ///< marked by a line
  std::string note;              ///< text in the middle, drawn if there are no bars
};

struct StackedUnder {
  int part = -1;                      ///< under the pointer; -1: none
  std::optional<std::int64_t> click;  ///< step that is clicked
};
StackedUnder plot_stacked(const char* id, float width, float height, const StackedBars& bars);

/// Upper end of an axis from 0: covers 90 % of the values, and all values up to 1.5 times that.
float stacked_axis(std::vector<float> values);

}  // namespace collidoscope

#pragma once
// A chart of y over x: named series of points with lines and spreads, on plain or logarithmic axes, each
// named at its right end. Over ImDrawList, between ImGui::NewFrame() and Render(); keeps nothing.

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace collidoscope {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// What is not finite (on a logarithmic axis: not above 0) is not drawn.
struct ChartPoint {
  double x = 0, y = 0;
  double x_low = no_value, x_high = no_value;  ///< spread, drawn as a bar
  double y_low = no_value, y_high = no_value;
};

struct ChartSeries {
  std::string name;
  std::uint32_t color = 0xffffffff;  ///< 0xAABBGGRR
  std::vector<ChartPoint> points;
  bool line = true;  ///< joins the points in their order
  bool dashed = false;
  bool marks = true;
};

struct ChartAxis {
  std::string label;                          ///< with the unit
  std::function<std::string(double)> number;  ///< how a value is written
  bool logarithmic = false;
  double least = no_value, most = no_value;  ///< not given: as the points need
};

struct Chart {
  std::string title, note;
  ChartAxis x, y;
  std::vector<ChartSeries> series;
};

struct ChartHit {
  int series = -1, point = -1;  ///< under the pointer; -1: none
};

/// In `width` x `height` pixels from the cursor on. Says what is under the pointer in a tooltip, and returns
/// it.
ChartHit draw_chart(const char* id, float width, float height, const Chart& chart);

/// The chart alone, black on white, on a whole frame of that size.
void draw_chart_page(float width, float height, float font_size, const Chart& chart);

/// A short number: 950, 1k, 50k, 2.5M.
std::string short_number(double value);

}  // namespace collidoscope

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
  std::uint32_t ring = 0;  ///< colour of a circle around it; 0: none
};

struct ChartSeries {
  std::string name;                  ///< empty: not named at its end
  std::uint32_t color = 0xffffffff;  ///< 0xAABBGGRR
  std::vector<ChartPoint> points;
  bool line = true;  ///< joins the points in their order
  bool dashed = false;
  bool broad = false;
  bool marks = true;
  int mark = -1;  ///< which of four shapes; -1: by the place among the series
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
  bool names = true;        ///< of the series, at their right ends
  double level = no_value;  ///< of y: a line across, with its name
  std::string level_name;
  double floor = no_value;  ///< of y: what lies below is veiled, and why
  std::string floor_name;
  bool fits_error_bars = true;  ///< else axes are as points need, and spreads end at their ends
  bool has_tooltip = true;      ///< what is under the pointer, in a tooltip
};

struct ChartHit {
  int series = -1, point = -1;                     ///< under the pointer; -1: none
  double x = no_value, y = no_value;               ///< at the pointer, on the chart's axes
  bool level = false;                              ///< the pointer is at the line across, and at no point
  float left = 0, top = 0, right = 0, bottom = 0;  ///< of what the axes enclose, in pixels of the screen
  float level_at = 0;                              ///< where the line across lies; 0: nowhere
  float level_name_at = 0;                         ///< the top of its name
  struct Place {
    int series, point;
    float x, y;
  };
  std::vector<Place> places{};  ///< of all that is drawn
};

/// In `width` x `height` pixels from the cursor on; the widget is an invisible button. Says what is under the
/// pointer, in a tooltip unless the chart says otherwise, and returns it.
ChartHit draw_chart(const char* id, float width, float height, const Chart& chart);

/// The chart alone, black on white, on a whole frame of that size.
void draw_chart_page(float width, float height, float font_size, const Chart& chart);

/// A short number: 950, 1k, 50k, 2.5M.
std::string short_number(double value);

}  // namespace collidoscope

#pragma once
// A chart of y versus x: named series with lines and error bars, on linear or logarithmic axes. The name of a
// series stands at its right end. Drawn with ImDrawList between ImGui::NewFrame() and Render(); stateless.

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace collidoscope {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// Not drawn if a value is not finite, or not positive on a logarithmic axis.
struct ChartPoint {
  double x = 0, y = 0;
  double x_low = no_value, x_high = no_value;  ///< error bar; NaN: none
  double y_low = no_value, y_high = no_value;
  std::uint32_t ring = 0;  ///< colour of a circle around the point; 0: none
};

struct ChartSeries {
  std::string name;                  ///< empty: no name at the right end
  std::uint32_t color = 0xffffffff;  ///< 0xAABBGGRR
  std::vector<ChartPoint> points;
  bool line = true;  ///< joins the points in order
  bool dashed = false;
  bool broad = false;
  bool marks = true;
  int mark = -1;  ///< one of four shapes; -1: by index of the series
};

struct ChartAxis {
  std::string label;                          ///< quantity and unit
  std::function<std::string(double)> number;  ///< formats a value
  bool logarithmic = false;
  double least = no_value, most = no_value;  ///< limits; NaN: from the points
};

struct Chart {
  std::string title, note;
  ChartAxis x, y;
  std::vector<ChartSeries> series;
  bool names = true;        ///< series names at the right ends
  double level = no_value;  ///< y value of a horizontal line; NaN: none
  std::string level_name;
  double floor = no_value;  ///< y value below which the area is shaded; NaN: none
  std::string floor_name;
  bool fits_error_bars = true;  ///< false: limits from the points only, error bars are clipped
  bool has_tooltip = true;      ///< tooltip of the point under the pointer
};

struct ChartHit {
  int series = -1, point = -1;        ///< under the pointer; -1: none
  double x = no_value, y = no_value;  ///< value at the pointer
  bool level = false;                 ///< whether the pointer is on the line `level` and on no point
  float left = 0, top = 0, right = 0, bottom = 0;  ///< plot area, in pixels of the screen
  float level_at = 0;                              ///< screen y of the line `level`; 0: not drawn
  float level_name_at = 0;                         ///< screen y of the top of its name
  struct Place {
    int series, point;
    float x, y;
  };
  std::vector<Place> places{};  ///< all drawn points
};

/// Draws the chart at the cursor as an invisible button of `width` x `height` pixels. Returns the element
/// under the pointer, with a tooltip if the chart has one.
ChartHit draw_chart(const char* id, float width, float height, const Chart& chart);

/// Draws the chart alone on white, as a whole frame of this size.
void draw_chart_page(float width, float height, float font_size, const Chart& chart);

/// A number with metric suffix: 950, 1k, 50k, 2.5M.
std::string short_number(double value);

}  // namespace collidoscope

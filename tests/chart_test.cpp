// Tests charts against golden pictures, and with degenerate input: no points, one point, equal points, values
// off the axis.

#include "ui/chart.h"

#include <gtest/gtest.h>
#include <imgui.h>

#include <cmath>

#include "headless/pictures/chart_picture.h"
#include "tests/gl_fixture.h"
#include "tests/golden.h"
#include "viewer/render/gui_pass.h"
#include "viewer/render/window_frame.h"

namespace collidoscope {
namespace {

Chart growth(bool logarithmic) {
  Chart chart;
  chart.title = "Three ways to grow";
  chart.note = "a machine; median, 5th to 95th percentile";
  chart.x = {"bodies", short_number, logarithmic};
  chart.y = {"µs", short_number, logarithmic};
  const std::pair<const char*, double> ways[] = {
      {"square root", 0.5}, {"linear", 1}, {"nearly linear", 1.02}};
  for (const auto& [name, exponent] : ways) {
    ChartSeries series{name, chart_color(chart.series.size()), {}};
    series.dashed = exponent == 1;
    for (const double n : {1e3, 3e3, 1e4, 3e4, 1e5}) {
      const double t = 0.1 * std::pow(n, exponent);
      ChartPoint point{n, t};
      point.y_low = 0.8 * t;
      point.y_high = 1.4 * t;
      series.points.push_back(point);
    }
    chart.series.push_back(series);
  }
  return chart;
}

TEST(Chart, LooksAsItDidOnLogarithmicAxes) {
  EXPECT_TRUE(looks_like_golden<"chart_log">(ChartPicture(900, 560).draw(growth(true))));
}

TEST(Chart, LooksAsItDidOnPlainAxes) {
  EXPECT_TRUE(looks_like_golden<"chart_plain">(ChartPicture(900, 560).draw(growth(false))));
}

TEST(Chart, ALineAcrossAFloorAndRings) {
  Chart chart = growth(true);
  chart.level = 300;
  chart.level_name = "300 µs allowed";
  chart.floor = 6;
  chart.floor_name = "less means nothing";
  chart.series[0].broad = true;
  chart.series[1].mark = 2;
  chart.series[1].points[2].ring = 0xff000000u;
  ChartPicture picture(900, 560);
  EXPECT_TRUE(looks_like_golden<"chart_level">(picture.draw(chart)));
  const Image named = picture.draw(chart);
  chart.names = false;
  EXPECT_FALSE(picture.draw(chart) == named);
}

TEST(Chart, LeavesOutWhatHasNoPlace) {
  Chart with = growth(true), without = growth(true);
  for (const double nowhere : {no_value, 0.0, -5.0, std::numeric_limits<double>::infinity()}) {
    with.series[0].points.push_back({nowhere, 10});
    with.series[0].points.push_back({1e4, nowhere});
  }
  ChartPicture picture(900, 560);
  EXPECT_EQ(picture.draw(with), picture.draw(without));
}

TEST(Chart, HoldsWithNothingOneOrTheSamePoints) {
  for (const bool logarithmic : {false, true}) {
    Chart chart = growth(logarithmic);
    for (ChartSeries& series : chart.series) series.points.resize(1);
    EXPECT_EQ(ChartPicture(300, 200).draw(chart).width, 300);
    for (ChartSeries& series : chart.series) series.points = {{7, 7}, {7, 7}};
    EXPECT_EQ(ChartPicture(300, 200).draw(chart).width, 300);
    chart.series[0].points.clear();
    EXPECT_EQ(ChartPicture(300, 200).draw(chart).width, 300);
    chart.series.clear();
    EXPECT_EQ(ChartPicture(20, 20).draw(chart).width, 20);
  }
}

TEST(Chart, WritesShortNumbers) {
  EXPECT_EQ(short_number(950), "950");
  EXPECT_EQ(short_number(1000), "1k");
  EXPECT_EQ(short_number(2'500'000), "2.5M");
  EXPECT_EQ(short_number(0.0125), "0.0125");
  EXPECT_EQ(short_number(-3e9), "-3G");
  EXPECT_EQ(short_number(0), "0");
}

TEST(Chart, TheLevelsNameStandsBesideItsLine) {
  Chart chart = growth(false);
  chart.y.least = 0;
  chart.y.most = 1000;
  chart.level_name = "100 mm allowed";
  test_context();
  GuiPass gui(13);
  WindowFrame frame(600, 400);
  for (const double level : {1000.0, 990.0, 960.0, 500.0, 10.0}) {
    chart.level = level;
    gui.begin(600, 400);
    const float line = ImGui::GetTextLineHeight();
    const ChartHit hit = draw_chart("chart", 560, 360, chart);
    gui.end(frame.target());
    EXPECT_GE(hit.level_name_at, hit.top) << level;
    EXPECT_TRUE(hit.level_name_at >= hit.level_at || hit.level_name_at + line <= hit.level_at) << level;
  }
}

}  // namespace
}  // namespace collidoscope

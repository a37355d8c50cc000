// Tests the chart of an accuracy study against its data. The chart needs one legend entry per method family,
// the error bounds of each point and the error floor of the reference.

#include <gtest/gtest.h>

#include <cmath>

#include "headless/accuracy/study_report.h"

namespace collidoscope {
namespace {

AccuracyPoint point(const std::string& series_name, Precision precision, double ms, double error) {
  AccuracyPoint p;
  p.series_name = series_name;
  p.setting.precision = precision;
  p.ms = {ms, 0.9 * ms, 1.1 * ms};
  p.error = error;
  p.error_low = 0.8 * error;
  p.error_high = 1.2 * error;
  return p;
}

AccuracyRecord record() {
  AccuracyRecord made;
  made.scene = "A scene";
  made.bodies = 12345;
  made.points = {point("soft_step f32", Precision::f32, 1, 1), point("soft_step f32", Precision::f32, 2, 0.1),
                 point("soft_step f32", Precision::f32, 3, 0.5),
                 point("soft_step f64", Precision::f64, 1.5, 1),
                 point("soft_step f64", Precision::f64, 4, 0.01)};
  mark_front(made.points);
  return made;
}

TEST(AccuracyChart, NamesEachFamilyOnceAndItsErrorsSpreads) {
  const Chart chart = study_chart(record(), 0.05);
  EXPECT_EQ(chart.title, "A scene, N = 12,345: what accuracy costs");
  EXPECT_EQ(chart.level, 0.05);
  std::vector<std::string> names;
  for (const ChartSeries& series : chart.series) {
    if (series.name.empty()) continue;
    names.push_back(series.name);
    for (const ChartPoint& p : series.points) EXPECT_DOUBLE_EQ(p.y_low, 0.8 * p.y);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"soft_step f32", "soft_step f64"}));
}

TEST(AccuracyChart, VeilsWhatTheReferenceCannotTellWhereThatIsNear) {
  AccuracyRecord far = record(), near = record();
  far.reference.error = 1e-9;
  near.reference.error = 0.004;
  EXPECT_TRUE(std::isnan(study_chart(far, {}).floor));
  EXPECT_EQ(study_chart(near, {}).floor, 0.004);
  EXPECT_TRUE(std::isnan(study_chart(near, {}).level));
}

}  // namespace
}  // namespace collidoscope

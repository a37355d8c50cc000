// The work-precision diagram of a study: what stands where.

#include "ui/accuracy_chart.h"

#include <gtest/gtest.h>

namespace collidoscope {
namespace {

AccuracyPoint point(const std::string& family, Precision precision, double ms, double error) {
  AccuracyPoint p;
  p.family = family;
  p.setting.precision = precision;
  p.ms = {ms, 0.9 * ms, 1.1 * ms};
  p.error = error;
  return p;
}

AccuracyRecord record() {
  AccuracyRecord made;
  made.scene = "test";
  made.points = {
      point("soft_step f32", Precision::f32, 1, 1),    point("soft_step f32", Precision::f32, 2, 0.1),
      point("soft_step f32", Precision::f32, 3, 0.5),  point("soft_step f64", Precision::f64, 1.5, 1),
      point("soft_step f64", Precision::f64, 4, 0.01), point("impulse f32", Precision::f32, 5, not_known)};
  mark_front(made.points);
  return made;
}

TEST(AccuracyChart, DrawsEachFamilysFrontAndTheRestAsDots) {
  const AccuracyChart made = accuracy_chart(record(), 0.05, true);
  const std::vector<ChartSeries>& series = made.chart.series;
  ASSERT_EQ(series.size(), 3u);  // what has no error is not drawn
  EXPECT_EQ(series[0].name, "soft_step f32");
  EXPECT_EQ(made.points[0], (std::vector<std::size_t>{0, 1}));
  EXPECT_FALSE(series[0].dashed);
  EXPECT_EQ(series[1].name, "soft_step f64");
  EXPECT_EQ(made.points[1], (std::vector<std::size_t>{3, 4}));
  EXPECT_TRUE(series[1].dashed);
  EXPECT_EQ(series[0].color, series[1].color);  // one family in two precisions
  EXPECT_EQ(series[2].name, "");
  EXPECT_TRUE(series[2].faint);
  EXPECT_EQ(made.points[2], (std::vector<std::size_t>{2}));
  EXPECT_TRUE(series[0].points[1].ringed);
  EXPECT_FALSE(series[1].points[0].ringed);
}

TEST(AccuracyChart, DrawsTheToleranceAndAReferenceThatIsNearTheErrors) {
  AccuracyRecord far = record(), near = record();
  far.reference.error = 1e-9;
  near.reference.error = 0.004;
  ASSERT_EQ(accuracy_chart(far, 0.05, true).chart.levels.size(), 1u);
  EXPECT_EQ(accuracy_chart(far, 0.05, true).chart.levels[0].y, 0.05);
  ASSERT_EQ(accuracy_chart(near, {}, true).chart.levels.size(), 1u);
  EXPECT_TRUE(accuracy_chart(near, {}, true).chart.levels[0].shaded);
  EXPECT_TRUE(accuracy_chart({}, {}, true).chart.series.empty());
}

}  // namespace
}  // namespace collidoscope

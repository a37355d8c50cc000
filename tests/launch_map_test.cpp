// Tests the picture of `tune` on invented times: the map as data, and its drawing.

#include "headless/tuning/launch_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "headless/pictures/chart_picture.h"
#include "tests/golden.h"
#include "tests/invented_search.h"

namespace collidoscope {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const HeatCell& cell_at(const HeatMap& map, LaunchShape shape) {
  const auto cell = std::ranges::find_if(
      map.cells, [&](const HeatCell& one) { return one.x == shape.blocks && one.y == shape.threads; });
  EXPECT_NE(cell, map.cells.end());
  return *cell;
}

TEST(LaunchMap, HasEachShapeWithItsRatioAndState) {
  const LaunchSearch search = invented_search();
  const HeatMap map = launch_map(invented_run(search), search);
  EXPECT_THAT(map.x.values, ElementsAre(8, 16, 33, 66, 132, 264, 528, 1056)) << "without shapes between";
  EXPECT_THAT(map.y.values, ElementsAre(32, 64, 128, 256, 512, 1024));
  ASSERT_EQ(map.cells.size(), search.cells().size());
  const std::vector<std::size_t> plateau = search.plateau();
  int thick = 0;
  for (std::size_t k = 0; k < map.cells.size(); ++k) {
    const LaunchCell& cell = search.cells()[k];
    const HeatCell& drawn = map.cells[k];
    EXPECT_EQ(drawn.kind == HeatCell::Kind::value, cell.state == LaunchCell::State::measured);
    if (drawn.kind == HeatCell::Kind::value) {
      EXPECT_EQ(drawn.value, cell.estimate().ratio);
    }
    EXPECT_EQ(drawn.frame != HeatCell::Frame::none, std::ranges::count(plateau, k) == 1);
    thick += drawn.frame == HeatCell::Frame::thick;
    EXPECT_EQ(drawn.frame == HeatCell::Frame::thick, search.chosen() == k);
  }
  EXPECT_EQ(thick, 1);
  EXPECT_EQ(cell_at(map, wrong_shape).kind, HeatCell::Kind::crossed);
  EXPECT_EQ(cell_at(map, {1056, 1024}).kind, HeatCell::Kind::hatched);
  EXPECT_EQ(cell_at(map, {8, 32}).kind, HeatCell::Kind::dashed);
  EXPECT_EQ(map.title, "Box Collider, 50,000 bodies: time of a step by launch shape");
  EXPECT_THAT(map.subtitle, HasSubstr("A GPU (cuda), state 60; auto takes 2.360 ms"));
  EXPECT_THAT(map.verdict, HasSubstr("faster than auto, 41 pairs; error: 1 shape with another state hash"));
}

TEST(LaunchMap, ColoursReachFromTheFastestToOneAndAHalfOfItsTime) {
  const LaunchSearch search = invented_search();
  TunedRun run = invented_run(search);
  HeatMap map = launch_map(run, search);
  double fastest = 1e9, slowest = 0;
  for (const HeatCell& cell : map.cells) {
    if (cell.kind != HeatCell::Kind::value) continue;
    fastest = std::min(fastest, cell.value);
    slowest = std::max(slowest, cell.value);
  }
  EXPECT_EQ(map.low, fastest);
  EXPECT_EQ(map.high, std::min(1.5 * fastest, slowest));
  EXPECT_EQ(map.level, 1);
  EXPECT_EQ(map.second_unit, 2.36);
  EXPECT_EQ(map.mark->x, 528);
  EXPECT_EQ(map.mark_name, "shape of auto for solve, its slowest stage");
  // A given shape.
  run.reference = {264, 128};
  run.reference_place = StageShape{"", {264, 128}};
  map = launch_map(run, search);
  EXPECT_EQ(map.mark_name, "current shape");
  EXPECT_EQ(map.bar_label, "ratio to current");
  EXPECT_THAT(map.note, HasSubstr("B = 264, T = 128"));
  // The times of auto on a CPU belong to no shape.
  run.reference_place.reset();
  EXPECT_FALSE(launch_map(run, search).mark);
}

TEST(LaunchMap, NumbersHaveThreeDigits) {
  const LaunchSearch search = invented_search();
  const HeatMap map = launch_map(invented_run(search), search);
  EXPECT_EQ(map.number(0.9666), "0.97");
  EXPECT_EQ(map.number(9.999), "10.0");
  EXPECT_EQ(map.number(99.97), "100");
}

TEST(LaunchMap, LooksAsItDid) {
  const LaunchSearch search = invented_search();
  EXPECT_TRUE(looks_like_golden<"launch_map">(
      ChartPicture(1200, 760).draw(launch_map(invented_run(search), search))));
}

/// Every kind of cell changes the picture.
TEST(LaunchMap, DrawsEachState) {
  const LaunchSearch search = invented_search();
  const HeatMap map = launch_map(invented_run(search), search);
  ChartPicture picture(1000, 700);
  const Image plain = picture.draw(map);
  HeatMap changed = map;
  HeatCell& cell = changed.cells.front();
  for (const HeatCell::Kind kind :
       {HeatCell::Kind::value, HeatCell::Kind::hatched, HeatCell::Kind::crossed, HeatCell::Kind::empty}) {
    cell.kind = kind;
    cell.value = 1;
    EXPECT_FALSE(picture.draw(changed) == plain);
  }
}

TEST(LaunchMap, HoldsWithoutAMeasurementAndWithOneShape) {
  const LaunchSearch nothing({1}, {32}, 32, 32);
  TunedRun run = invented_run(nothing);
  run.reference_ms = std::nan("");
  run.reference_place.reset();
  const HeatMap map = launch_map(run, nothing);
  EXPECT_EQ(map.verdict, "no shape was measured; a longer --budget is needed");
  EXPECT_EQ(ChartPicture(300, 200).draw(map).width, 300);
  EXPECT_EQ(ChartPicture(20, 20).draw(map).width, 20);
}

}  // namespace
}  // namespace collidoscope

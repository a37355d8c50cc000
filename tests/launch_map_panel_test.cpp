// Tests the launch map panel: its picture with invented times against a golden, and a click on a cell.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/gl_fixture.h"
#include "tests/golden.h"
#include "tests/single_panel.h"
#include "viewer/render/legend.h"

namespace collidoscope {
namespace {

/// A GPU with 132 multiprocessors: every kind of cell, two refined ones, and a stage with its occupancy.
LaunchMapView invented_map() {
  LaunchMapView map;
  LaunchMapView::Stage solve{"solve", 0.21, {264, 256}, {}, {}};
  const auto add = [&](int blocks, int threads) {
    const double b = std::log2(blocks) - std::log2(264), t = std::log2(threads) - 7;
    const double ratio = 0.94 + 0.04 * b * b + 0.05 * t * t + (b + t < -4 ? 2 * (-4 - b - t) : 0);
    LaunchCell cell{.shape = {blocks, threads}, .reason = {}, .ratios = {}, .ms = {}};
    if (blocks == 8 && threads < 256) {
      cell.state = LaunchCell::State::left_out;
      cell.reason = "16 x 64 is much slower than the best";
    } else if (threads == 1024 && blocks > 264) {
      cell.state = LaunchCell::State::infeasible;
      cell.reason = "too many registers";
    } else if (blocks == 528 && threads == 64) {
      cell.state = LaunchCell::State::wrong;
      cell.reason = "state 12: hash 0000000000000001, expected 0000000000000000";
    } else if (!(blocks == 1056 && threads == 512)) {
      cell.state = LaunchCell::State::measured;
      for (int pair = 0; pair < 16; ++pair) {
        cell.ratios.push_back(ratio * (1 + 0.002 * (pair % 5)));
        cell.ms.push_back(0.5 * cell.ratios.back());
      }
    }
    map.cells.push_back(cell);
    solve.cell_ms.push_back(cell.state == LaunchCell::State::measured ? 0.2 * ratio * ratio : NAN);
    solve.occupancy.push_back(threads <= 64 ? 0.5 : threads <= 256 ? 0.75 : 1);
  };
  for (const int blocks : {8, 16, 33, 66, 132, 264, 528, 1056})
    for (const int threads : {32, 64, 128, 256, 512, 1024}) add(blocks, threads);
  add(264, 96);
  add(192, 128);
  map.stages.push_back(solve);
  const auto index = [&](int blocks, int threads) {
    const auto cell = std::ranges::find(map.cells, LaunchShape{blocks, threads}, &LaunchCell::shape);
    return static_cast<std::size_t>(cell - map.cells.begin());
  };
  map.chosen = index(264, 128);
  map.plateau = {index(264, 128), index(192, 128), index(132, 128), index(264, 256)};
  map.reference_ms = 0.5;
  map.now = {66, 256};
  map.start_state = 1200;
  map.bodies = 50'000;
  map.spent = map.budget = 5;
  map.begun = map.done = true;
  map.is_faster = true;
  map.verdict = "B = 264, T = 128: 5.9 % ± 0.2 faster than auto, 41 pairs";
  map.stage_verdict = "6.8 % ± 0.2 faster than auto, 41 pairs";
  map.stage_shapes = "solve=264x128";
  map.colors = value_legend();
  return map;
}

struct LaunchMapPanel : SinglePanel {
  LaunchMapPanel() : SinglePanel(draw_launch_map_panel, 338, 430) {
    workspace.visible_panels.launch_map = true;
    view.launch_map = &map;
  }
  ImVec2 place_of(LaunchShape shape) const {
    for (const LaunchMapPlace& place : workspace.launch_map.places)
      if (map.cells[place.cell].shape == shape) return {place.x, place.y};
    ADD_FAILURE() << shape.blocks << " x " << shape.threads << " is not drawn";
    return {-1, -1};
  }
  LaunchMapView map = invented_map();
};

TEST(PanelPicture, LaunchMap) {
  test_context();
  {
    LaunchMapPanel dark;
    EXPECT_TRUE(looks_like_golden<"launch_map_dark">(dark.picture()));
  }
  LaunchMapPanel light;
  light.workspace.theme = Theme::light;
  light.workspace.launch_map.stage = "solve";
  light.picture();
  light.pointer = light.place_of({132, 64});
  EXPECT_TRUE(looks_like_golden<"launch_map_light">(light.picture()));
}

TEST(PanelPicture, ACellOfTheLaunchMapIsAShape) {
  test_context();
  LaunchMapPanel panel;
  panel.picture();
  const auto click = [&](LaunchShape shape) {
    panel.workspace.settings.run.shape = {};
    panel.mouse(panel.place_of(shape), true);
    panel.mouse(panel.place_of(shape), false);
    return panel.workspace.settings.run.shape;
  };
  EXPECT_EQ(click({132, 64}), (LaunchShape{132, 64}));
  EXPECT_EQ(click({192, 128}), (LaunchShape{192, 128})) << "a refined cell";
  EXPECT_EQ(click({8, 32}), (LaunchShape{8, 32})) << "left out";
  EXPECT_EQ(click({1056, 1024}), LaunchShape{}) << "cannot be launched";
  const auto wrong = std::ranges::find(panel.map.cells, LaunchCell::State::wrong, &LaunchCell::state);
  ASSERT_NE(wrong, panel.map.cells.end());
  EXPECT_EQ(click(wrong->shape), LaunchShape{}) << "another result";
  EXPECT_EQ(panel.workspace.launch_map.places.size(), panel.map.cells.size());
}

}  // namespace
}  // namespace collidoscope

// Tests boxes and bodies coloured by tree metrics against goldens, and the filter by a range of values.

#include <gmock/gmock.h>

#include <limits>

#include "headless/compare.h"
#include "tests/gl_fixture.h"
#include "tests/golden.h"
#include "tests/scenes.h"
#include "viewer/render/interop/display_link.h"
#include "viewer/render/legend.h"
#include "viewer/render/value_range.h"

namespace collidoscope {
namespace {

RunOptions on_cpu() {
  RunOptions options;
  options.executor = ExecutorKind::cpu;
  options.broad_phase = "bvh_bottom_up";
  return options;
}

struct Shown {
  Image picture;
  ValueRange range;
};

Shown draw(const FrameLayers& layers, std::int64_t bodies = 120) {
  test_context();
  Scene scene = box_collider(bodies);
  scene.physics.integrator = Integrator::semi_implicit_euler;  // of the goldens
  World world(scene, on_cpu());
  world.step(10);
  const StepStats stats = world.measure();
  Renderer renderer(360, 270);
  renderer.set_scene(frame_scene(world.scene(), world.initial()));
  DisplayLink link(world.info(), DisplayPath::automatic, [](const std::string&) {});
  link.publish(world, layers, renderer.instances());
  const ValueRange range = value_range(world, renderer.scene(), layers, stats);
  renderer.draw(scene_camera({}, renderer.scene().bounds, 360.0 / 270), layers, range);
  return {renderer.read_picture(), range};
}

FrameLayers boxes_by(NodeMetric metric) {
  FrameLayers layers{.spheres = true, .boxes = true, .first_level = 1, .overlay = false};
  layers.box_color = metric;
  return layers;
}

TEST(TreeColors, BoxesByShareOfSah) {
  EXPECT_TRUE(looks_like_golden<"boxes_sah">(draw(boxes_by(NodeMetric::sah_share)).picture));
}
TEST(TreeColors, BoxesByOverlap) {
  EXPECT_TRUE(looks_like_golden<"boxes_overlap">(draw(boxes_by(NodeMetric::sibling_overlap)).picture));
}
TEST(TreeColors, BoxesByEmptySpace) {
  EXPECT_TRUE(looks_like_golden<"boxes_empty">(draw(boxes_by(NodeMetric::empty_space)).picture));
}
TEST(TreeColors, BoxesByVisits) {
  EXPECT_TRUE(looks_like_golden<"boxes_visits">(draw(boxes_by(NodeMetric::visits)).picture));
}
TEST(TreeColors, BodiesByDepth) {
  EXPECT_TRUE(looks_like_golden<"bodies_depth">(draw({.spheres = true, .color = BodyColor::depth}).picture));
}
TEST(TreeColors, BodiesByVisits) {
  EXPECT_TRUE(
      looks_like_golden<"bodies_visits">(draw({.spheres = true, .color = BodyColor::visits}).picture));
}

TEST(TreeColors, WhatLiesOutsideOfTheRangeIsNotDrawn) {
  FrameLayers layers = boxes_by(NodeMetric::visits);
  layers.spheres = layers.grid = layers.walls = false;
  const Shown all = draw(layers);
  EXPECT_EQ(all.range.boxes, 120 + 60 + 30 + 15 + 8 + 4 + 2);
  layers.box_low = static_cast<float>(all.range.box_max);
  const Shown worst = draw(layers);
  EXPECT_GE(worst.range.boxes, 1);
  EXPECT_LE(worst.range.boxes, 4);
  layers.box_low = static_cast<float>(all.range.box_max) + 1;
  const Shown none = draw(layers);
  EXPECT_EQ(none.range.boxes, 0);
  layers.boxes = false;
  EXPECT_EQ(draw(layers).picture, none.picture);
  EXPECT_GT(compare_images(worst.picture, none.picture).share_over_5, 0.001);
  EXPECT_GT(compare_images(all.picture, none.picture).share_over_5,
            3 * compare_images(worst.picture, none.picture).share_over_5);
  EXPECT_EQ(box_legend(NodeMetric::visits, none.range).title, "") << "no boxes, no legend";
  EXPECT_TRUE(box_legend(NodeMetric::visits, all.range).logarithmic);
}

TEST(TreeColors, AMethodWithoutATreeIsDrawnWithoutOne) {
  test_context();
  RunOptions options = on_cpu();
  options.broad_phase = "uniform_grid";
  World world(box_collider(50), options);
  FrameLayers layers = boxes_by(NodeMetric::visits);
  layers.color = BodyColor::visits;
  Renderer renderer(64, 48);
  renderer.set_scene(frame_scene(world.scene(), world.initial()));
  DisplayLink link(world.info(), DisplayPath::automatic, [](const std::string&) {});
  link.publish(world, layers, renderer.instances());
  const ValueRange range = value_range(world, renderer.scene(), layers, world.measure());
  EXPECT_EQ(range.boxes, 0);
  EXPECT_EQ(range.max, 0);
  renderer.draw(scene_camera({}, renderer.scene().bounds, 4.0 / 3), layers, range);
}

TEST(ErrorScale, TheGreatestErrorStaysInThePicture) {
  std::vector<float> errors(100, 1e-4f);
  EXPECT_EQ(automatic_error_scale(errors, 1, 100), 1e4) << "two bodies wide: 2 m";
  errors[0] = 0.1f;
  EXPECT_EQ(automatic_error_scale(errors, 1, 100), 100) << "25 m of 100 m";
  errors[0] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(automatic_error_scale(errors, 1, 100), 1e4);
  EXPECT_EQ(automatic_error_scale({}, 1, 100), 1);
  EXPECT_EQ(automatic_error_scale({0, 0}, 1, 100), 1);
  EXPECT_EQ(automatic_error_scale({1000}, 1, 100), 1);
}

}  // namespace
}  // namespace collidoscope

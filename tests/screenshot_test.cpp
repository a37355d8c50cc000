// Tests pictures against goldens (tests/golden.h), tightly for known renderers and loosely for others.

#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>

#include "headless/compare.h"
#include "tests/gl_fixture.h"
#include "tests/golden.h"
#include "ui/overlay.h"
#include "viewer/render/colors.h"
#include "viewer/render/gui_pass.h"

namespace collidoscope {
namespace {

constexpr int shot_width = 360, shot_height = 270;

// Overlapping spheres with two levels of boxes and a contact between neighbours.
struct Example {
  TestBodies bodies = test_spheres(120, 10, 11);
  std::vector<BoxInstance> boxes{box_instance({0, 0, 0}, {100, 100, 100}, 0),
                                 box_instance({2, 3, 4}, {48, 97, 90}, 1),
                                 box_instance({52, 3, 4}, {98, 97, 90}, 1)};
  std::vector<ContactInstance> contacts;
  std::vector<GhostInstance> ghosts;
  double error_scale = 1;
  FrameLayers layers{.spheres = true, .boxes = true, .first_level = 0, .last_level = 1, .contacts = true};

  Example() {
    for (std::size_t i = 0; i + 1 < bodies.instances.size(); i += 4) {
      ContactInstance contact{};
      for (int k = 0; k < 3; ++k) contact.point[k] = bodies.instances[i].center[k];
      contact.point[2] += bodies.instances[i].radius;
      contact.normal[2] = 1;
      contact.radius = bodies.instances[i].radius;
      contacts.push_back(contact);
    }
  }

  Image draw(bool orthographic = false) const {
    test_context();
    Renderer renderer(shot_width, shot_height);
    renderer.set_scene(frame_scene(bodies.scene, bodies.initial));
    renderer.instances().upload(std::span<const BodyInstance>(bodies.instances));
    renderer.instances().upload(std::span<const BoxInstance>(boxes));
    renderer.instances().upload(std::span<const ContactInstance>(contacts));
    renderer.set_ghosts(ghosts);
    OrbitCamera camera =
        scene_camera({}, renderer.scene().bounds, static_cast<double>(shot_width) / shot_height);
    camera.orthographic = orthographic;
    ValueRange values{0, 1};
    values.error_scale = error_scale;
    renderer.draw(camera, layers, values);
    if (layers.overlay) {
      OverlayText text;
      text.scene = "A golden scene Σ ≤ µ · × ³";
      text.state = 1234;
      text.bodies = 120;
      text.shape = {16, 256};
      text.pairs = 1234567;
      text.stages = {{.name = "bounds"}, {.name = "sort"}};
      text.body_colors.title = "value";
      for (const Rgb& color : color_map())
        text.body_colors.colors.push_back(0xff000000u | static_cast<PackedColor>(color.b * 255) << 16 |
                                          static_cast<PackedColor>(color.g * 255) << 8 |
                                          static_cast<PackedColor>(color.r * 255));
      text.grid_spacing = 10;
      GuiPass gui(11);
      gui.begin(shot_width, shot_height);
      draw_overlay(text, static_cast<float>(shot_width), static_cast<float>(shot_height));
      gui.end(renderer.picture());
    }
    return renderer.read_picture();
  }
};

TEST(Screenshot, AllLayers) { EXPECT_TRUE(looks_like_golden<"all_layers">(Example().draw())); }

TEST(Screenshot, SpheresInOrthographicView) {
  Example example;
  example.layers = {.spheres = true, .overlay = false, .color = BodyColor::id};
  EXPECT_TRUE(looks_like_golden<"orthographic">(example.draw(true)));
}

/// Ghosts beside every third sphere, at a distance given by its id. Every ninth is unknown.
Example with_ghosts() {
  Example example;
  example.layers = {.spheres = true, .ghosts = true, .errors = true, .overlay = false};
  example.error_scale = 2;
  for (std::size_t i = 0; i < example.bodies.instances.size(); i += 3) {
    const BodyInstance& body = example.bodies.instances[i];
    GhostInstance ghost{};
    for (int k = 0; k < 3; ++k) ghost.body[k] = body.center[k];
    ghost.radius = body.radius;
    ghost.offset[i % 2] = 0.06f * static_cast<float>(i);
    ghost.offset[2] = 3;
    ghost.opacity = i % 9 == 0 ? 0.0f : 1.0f;
    example.ghosts.push_back(ghost);
  }
  return example;
}

TEST(Screenshot, GhostsAndErrors) { EXPECT_TRUE(looks_like_golden<"ghosts">(with_ghosts().draw())); }

TEST(Screenshot, GhostsAndErrorsLeaveTheirMarks) {
  const Example both = with_ghosts();
  const Image all = both.draw();
  for (bool FrameLayers::*layer : {&FrameLayers::ghosts, &FrameLayers::errors}) {
    Example without = both;
    without.layers.*layer = false;
    EXPECT_GT(compare_images(all, without.draw()).max_channel, 60);
  }
  Example longer = both, unknown = both, none = both;
  longer.error_scale = 4;
  EXPECT_GT(compare_images(all, longer.draw()).max_channel, 60);
  for (GhostInstance& ghost : unknown.ghosts) ghost.opacity = 0;
  none.layers.ghosts = none.layers.errors = false;
  EXPECT_EQ(unknown.draw(), none.draw()) << "what is not known is not drawn";
}

TEST(Screenshot, TheSameFrameTwiceIsTheSameBytes) {
  const Example example;
  EXPECT_EQ(example.draw(), example.draw());
}

TEST(Screenshot, EveryLayerLeavesItsMark) {
  Example example;
  const Image all = example.draw();
  for (bool FrameLayers::*layer : {&FrameLayers::spheres, &FrameLayers::boxes, &FrameLayers::contacts,
                                   &FrameLayers::grid, &FrameLayers::walls, &FrameLayers::overlay}) {
    Example without;
    without.layers.*layer = false;
    EXPECT_GT(compare_images(all, without.draw()).max_channel, 10);
  }
}

TEST(Screenshot, AMovedSphereIsFound) {
  // An injected error: one of 120 spheres moved by its radius fails the tight comparison. The loose
  // comparison allows for other drivers; it fails if a tenth of the spheres move.
  const Example right;
  const Image golden = right.draw();
  const auto difference = [&](const Image& picture, const capture::Tolerance& tolerance) {
    return capture::compare(pixels_of(picture), pixels_of(golden), tolerance).text;
  };
  EXPECT_EQ(difference(golden, capture::tight()), "");
  Example wrong;
  std::size_t largest = 0;
  for (std::size_t i = 0; i < wrong.bodies.instances.size(); ++i)
    if (wrong.bodies.instances[i].center[1] - wrong.bodies.instances[largest].center[1] < 0) largest = i;
  wrong.bodies.instances[largest].center[2] += wrong.bodies.instances[largest].radius;
  EXPECT_THAT(difference(wrong.draw(), capture::tight()), testing::HasSubstr("differ by more than 5 of 255"));
  for (std::size_t i = 0; i < wrong.bodies.instances.size(); i += 4)
    wrong.bodies.instances[i].center[2] += 12;
  EXPECT_THAT(difference(wrong.draw(), capture::loose()), testing::HasSubstr("the perceptual difference"));
}

}  // namespace
}  // namespace collidoscope

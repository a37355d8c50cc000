// Tests quick lighting against full lighting: the colours must agree. Also tests that pictures are opaque.
#include "viewer/render/light_pass.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/gl_fixture.h"

namespace collidoscope {
namespace {

constexpr int light_width = 320, light_height = 240;

Image draw(Quality quality, bool spheres, int supersampling = 1) {
  const TestBodies bodies = test_spheres(120, 9, 4);
  Renderer renderer(light_width, light_height, {.supersampling = supersampling, .light = quality});
  renderer.set_scene(frame_scene(bodies.scene, bodies.initial));
  renderer.instances().upload(std::span<const BodyInstance>(bodies.instances));
  renderer.draw(scene_camera({}, renderer.scene().bounds, static_cast<double>(light_width) / light_height),
                {.spheres = spheres, .grid = spheres}, {0, 1});
  return renderer.read_picture();
}

/// Mean and largest difference of a channel, in 255ths.
std::pair<double, int> difference(const Image& a, const Image& b) {
  double sum = 0;
  int most = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) {
    const int d = std::abs(a.rgba[i] - b.rgba[i]);
    sum += d;
    most = std::max(most, d);
  }
  return {sum / static_cast<double>(a.rgba.size()), most};
}

TEST(LightPass, QuickLightHasTheColoursOfTheFullOne) {
  test_context();
  // Without bodies the two differ only by the fit of the powers. With bodies they also differ in occlusion
  // and shadow edges.
  EXPECT_LE(difference(draw(Quality::quick, false), draw(Quality::full, false)).second, 3);
  EXPECT_LT(difference(draw(Quality::quick, true), draw(Quality::full, true)).first, 8);
}

TEST(LightPass, PicturesAreOpaqueHoweverManySamples) {
  test_context();
  for (int samples : {1, 2, 3}) {
    const Image picture = draw(Quality::full, true, samples);
    for (std::size_t i = 3; i < picture.rgba.size(); i += 4) ASSERT_EQ(picture.rgba[i], 255) << samples;
  }
}

}  // namespace
}  // namespace collidoscope

// Tests passes over whole pictures as compute shaders against fragment shaders. The pictures must agree.

#include "viewer/render/gl/pixel_pass.h"

#include <gtest/gtest.h>

#include "headless/compare.h"
#include "tests/gl_fixture.h"

namespace collidoscope {
namespace {

/// Bodies, planes that fade out, and background.
Image lit_by(LightMethod method, DrawOptions options, const TestBodies& bodies, int width, int height) {
  options.light_method = method;
  Renderer renderer(width, height, options);
  renderer.set_scene(frame_scene(bodies.scene, bodies.initial));
  renderer.instances().upload(std::span<const BodyInstance>(bodies.instances));
  const OrbitCamera camera = scene_camera({}, renderer.scene().bounds, static_cast<double>(width) / height);
  renderer.draw(camera, {.spheres = true}, {0, 1});
  return renderer.read_picture();
}

// Sizes that are no multiple of a work group.
TEST(PixelPass, ComputeShadersLightAsFragmentShadersDo) {
  test_context();
  const TestBodies bodies = test_spheres(150, 9, 1);
  for (const Quality quality : {Quality::full, Quality::quick})
    for (const int supersampling : {1, 2, 3})
      for (const auto& [width, height] : {std::pair{203, 149}, {64, 16}}) {
        const DrawOptions options{.supersampling = supersampling, .light = quality};
        const Image expected = lit_by(LightMethod::fragments, options, bodies, width, height);
        const ImageDifference difference =
            compare_images(expected, lit_by(LightMethod::compute, options, bodies, width, height));
        EXPECT_LE(difference.max_channel, 1) << quality_name(quality) << ' ' << supersampling;
      }
}

TEST(PixelPass, TheMethodCanChange) {
  test_context();
  const TestBodies bodies = test_spheres(150, 9, 1);
  Renderer renderer(203, 149, {.light_method = LightMethod::compute});
  renderer.set_scene(frame_scene(bodies.scene, bodies.initial));
  renderer.instances().upload(std::span<const BodyInstance>(bodies.instances));
  const OrbitCamera camera = scene_camera({}, renderer.scene().bounds, 203.0 / 149);
  const auto picture = [&](LightMethod method, int supersampling) {
    renderer.set_options({.supersampling = supersampling, .light_method = method});
    renderer.draw(camera, {.spheres = true}, {0, 1});
    return renderer.read_picture();
  };
  for (const int supersampling : {1, 2})
    EXPECT_LE(compare_images(picture(LightMethod::fragments, supersampling),
                             picture(LightMethod::compute, supersampling))
                  .max_channel,
              1);
}

}  // namespace
}  // namespace collidoscope

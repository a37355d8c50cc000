// Tests the drawing of spheres smaller than a pixel against their projected area and a larger sphere's
// colour. None may vanish, be larger than a pixel, or have another colour.

#include "viewer/render/body_pass.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/gl_fixture.h"

namespace collidoscope {
namespace {

constexpr int pass_width = 480, pass_height = 360;
constexpr double picture_pixel = 100.0 / pass_height;  // m

/// An orthographic view from above of 100 m height: 3.6 pixels per metre.
OrbitCamera plan_view() {
  OrbitCamera camera;
  camera.orthographic = true;
  camera.field_of_view = 1;
  camera.distance = 50 / std::tan(0.5);
  camera.target = {50, 50, 50};
  camera.elevation = std::numbers::pi / 2;
  camera.azimuth = -std::numbers::pi / 2;
  return camera;
}

/// 20 x 20 spheres of one radius (in pixels), about 4 m apart, each with its own offset within a pixel.
TestBodies lattice(double radius_px) {
  TestBodies bodies;
  bodies.scene.box = Box{};
  bodies.initial.box = Box{};
  TestRandom random(3);
  const double radius = radius_px * picture_pixel;
  for (int i = 0; i < 400; ++i) {
    const Vector3d center(12 + 4 * (i % 20) + random(), 12 + 4 * (i / 20) + random(), 50);
    bodies.initial.position.push_back(center);
    bodies.initial.radius.push_back(radius);
    bodies.instances.push_back(sphere_instance(center, radius, 0.7, static_cast<std::uint32_t>(i)));
  }
  return bodies;
}

/// A distant, oblique perspective view.
OrbitCamera far_view() {
  OrbitCamera camera;
  camera.target = {50, 50, 50};
  camera.elevation = 0.9;
  camera.distance = 260;
  return camera;
}

/// The pixel at which a point is seen.
std::pair<int, int> pixel_of(const OrbitCamera& camera, const Vector3d& place) {
  const Vector3d at = camera.axes().transpose() * (place - camera.eye());
  const double reach =
      std::tan(0.5 * camera.field_of_view) * (camera.orthographic ? camera.distance : -at.z());
  return {static_cast<int>(std::floor(at.x() / reach * pass_height / 2 + pass_width / 2.0)),
          static_cast<int>(std::floor(pass_height / 2.0 - at.y() / reach * pass_height / 2))};
}

struct Plan {
  explicit Plan(double radius_px, DrawOptions options = {.supersampling = 1})
      : bodies(lattice(radius_px)), renderer(pass_width, pass_height, options) {
    renderer.set_scene(frame_scene(bodies.scene, bodies.initial));
    renderer.instances().upload(std::span<const BodyInstance>(bodies.instances));
  }
  Image draw(bool spheres, const OrbitCamera& camera = plan_view()) {
    renderer.draw(camera, {.spheres = spheres, .grid = false, .walls = false}, {0, 1});
    return renderer.read_picture();
  }

  TestBodies bodies;
  Renderer renderer;
};

TEST(BodyPass, NoSphereIsTooSmallToBeSeenAndPicked) {
  test_context();
  for (const OrbitCamera& camera : {plan_view(), far_view()})
    for (double radius_px : {0.001, 0.1, 0.45, 0.6, 0.74}) {
      Plan plan(radius_px);
      const Image with = plan.draw(true, camera), without = plan.draw(false, camera);
      const std::vector<std::uint32_t> ids = plan.renderer.draw_ids(camera, {});
      int hidden = 0;
      for (std::uint32_t i = 0; i < 400; ++i) {
        const auto [x, y] = pixel_of(camera, plan.bodies.initial.position[i]);
        const auto pixel = static_cast<std::size_t>(y) * pass_width + static_cast<std::size_t>(x);
        ASSERT_EQ(plan.renderer.pick(camera, {}, x, y), ids[pixel]);
        // In an oblique view a nearer sphere may have its centre in the same pixel.
        hidden += ids[pixel] != i + 1;
        ASSERT_GT(ids[pixel], 0u) << radius_px << " " << i;
        int brighter = 0;
        for (std::size_t k = 0; k < 3; ++k)
          brighter += with.rgba[4 * pixel + k] - without.rgba[4 * pixel + k];
        ASSERT_GT(brighter, 30) << radius_px << " " << i;
      }
      EXPECT_LE(hidden, camera.orthographic ? 0 : 8) << radius_px;
    }
}

TEST(BodyPass, SmallSpheresCoverWhatTheyShould) {
  test_context();
  for (double radius_px : {0.001, 0.25, 0.5, 0.75, 1.0, 1.5}) {
    Plan plan(radius_px);
    int covered = 0;
    for (std::uint32_t id : plan.renderer.draw_ids(plan_view(), {})) covered += id > 0;
    const double area = 400 * std::numbers::pi * radius_px * radius_px;
    if (radius_px <= 0.5)  // inside one pixel: one pixel each
      EXPECT_EQ(covered, 400) << radius_px;
    else
      EXPECT_NEAR(covered, area, 0.05 * area) << radius_px;
  }
}

/// The mean colour of the changed pixels, weighted by coverage.
struct Light {
  double rgb[3] = {};
};
Light light_of(Plan& plan) {
  const Image with = plan.draw(true);
  const std::vector<std::uint32_t> ids = plan.renderer.draw_ids(plan_view(), {});
  Light light;
  double count = 0;
  for (std::size_t pixel = 0; pixel < ids.size(); ++pixel) {
    if (ids[pixel] == 0) continue;
    ++count;
    for (std::size_t k = 0; k < 3; ++k) light.rgb[k] += with.rgba[4 * pixel + k];
  }
  for (double& channel : light.rgb) channel /= count;
  return light;
}

TEST(BodyPass, APointHasTheColourOfASphere) {
  test_context();
  // At a radius of 6 pixels the bodies are drawn as spheres. As points, each samples one place of its
  // surface, and together they sample the whole surface. Points have no occlusion, so it is off.
  Plan spheres(6, {.supersampling = 1, .light = Quality::quick});
  const Light expected = light_of(spheres);
  for (double radius_px : {0.05, 0.3, 0.6, 1.0}) {
    Plan points(radius_px, {.supersampling = 1, .light = Quality::quick});
    const Light found = light_of(points);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(found.rgb[k], expected.rgb[k], 0.1 * 255) << radius_px;
  }
}

}  // namespace
}  // namespace collidoscope

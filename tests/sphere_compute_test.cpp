// Tests spheres drawn by a compute shader against spheres drawn as quads. The pictures must agree for all
// scenes and cameras.

#include "viewer/render/sphere_compute.h"

#include <gtest/gtest.h>

#include "headless/compare.h"
#include "tests/gl_fixture.h"

namespace collidoscope {
namespace {

constexpr int frame_width = 360, frame_height = 270;

Image draw(const TestBodies& bodies, const OrbitCamera& camera, SphereMethod method) {
  Renderer renderer(frame_width, frame_height, {.spheres = method});
  renderer.set_scene(frame_scene(bodies.scene, bodies.initial));
  renderer.instances().upload(std::span<const BodyInstance>(bodies.instances));
  renderer.draw(camera, {.spheres = true}, {0, 1});
  EXPECT_EQ(renderer.computes_spheres(), method == SphereMethod::compute);
  return renderer.read_picture();
}

void expect_same_picture(const TestBodies& bodies, const OrbitCamera& camera) {
  const Image quads = draw(bodies, camera, SphereMethod::quads);
  // Drivers may round the two methods differently, which is visible at outlines.
  const ImageDifference difference = compare_images(quads, draw(bodies, camera, SphereMethod::compute));
  EXPECT_LE(difference.share_over_5, 0.0005);
  EXPECT_LE(difference.perceptual_mean, 0.0005);
}

OrbitCamera standard_camera(const TestBodies& bodies) {
  return scene_camera({}, frame_scene(bodies.scene, bodies.initial).bounds,
                      static_cast<double>(frame_width) / frame_height);
}

TEST(SphereCompute, LargeAndSmallSpheresLookTheSame) {
  test_context();
  for (const auto& [count, radius] : {std::pair{1, 40.0}, {150, 9.0}, {3000, 2.0}, {20000, 0.4}}) {
    const TestBodies bodies = test_spheres(count, radius, 1);
    expect_same_picture(bodies, standard_camera(bodies));
  }
}

TEST(SphereCompute, FromEverywhere) {
  test_context();
  TestBodies bodies = test_spheres(400, 7, 2);
  OrbitCamera camera = standard_camera(bodies);
  camera.orthographic = true;
  expect_same_picture(bodies, camera);

  camera.orthographic = false;
  camera.target = {50, 50, 50};
  camera.distance = 1;
  camera.field_of_view =
      1.9;  // a wide view among the spheres: outlines are not circular, some extend behind the camera
  expect_same_picture(bodies, camera);

  bodies.initial.position.push_back(camera.eye());
  bodies.initial.radius.push_back(3);
  bodies.instances.push_back(
      sphere_instance(camera.eye(), 3, 0, 400));  // contains the camera, so it is not drawn
  expect_same_picture(bodies, camera);

  camera.distance = 1e5;  // all spheres in one or two pixels
  expect_same_picture(bodies, camera);
}

TEST(SphereCompute, MeshesStandAmongThem) {
  test_context();
  TestBodies bodies = test_spheres(40, 9, 5);
  Mesh tetrahedron;
  tetrahedron.vertices = {{12, 12, 12}, {12, -12, -12}, {-12, 12, -12}, {-12, -12, 12}};
  tetrahedron.faces = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  bodies.initial.meshes.push_back(tetrahedron);
  bodies.initial.mesh.assign(40, 0);
  for (std::size_t i : {0u, 7u, 39u}) bodies.initial.mesh[i] = bodies.instances[i].mesh = 1;
  expect_same_picture(bodies, standard_camera(bodies));
}

TEST(SphereCompute, WhichOfTwoInOnePlaceIsSeenDoesNotDependOnTheMethod) {
  test_context();
  TestBodies bodies = test_spheres(2, 5, 6);
  bodies.instances.clear();
  bodies.initial.position.clear();
  for (std::uint32_t id : {0u, 1u, 2u, 3u}) {
    const double radius = id < 2 ? 20 : 1;
    const Vector3d center = id < 2 ? Vector3d(50, 50, 50) : Vector3d(10, 10, 10);
    bodies.initial.position.push_back(center);
    bodies.instances.push_back(sphere_instance(center, radius, id % 2 ? 1 : 0, id));
  }
  bodies.initial.radius = {20, 20, 1, 1};
  expect_same_picture(bodies, standard_camera(bodies));
}

TEST(SphereCompute, FramesFollowEachOtherInAnySize) {
  test_context();
  const TestBodies many = test_spheres(500, 6, 7), none = test_spheres(0, 6, 7);
  Renderer renderer(frame_width, frame_height, {.spheres = SphereMethod::compute});
  renderer.set_scene(frame_scene(many.scene, many.initial));
  const OrbitCamera camera = standard_camera(many);
  const auto frame = [&](const TestBodies& bodies) {
    renderer.instances().upload(std::span<const BodyInstance>(bodies.instances));
    renderer.draw(camera, {.spheres = true}, {0, 1});
    return renderer.read_picture();
  };
  const Image first = frame(many), empty = frame(none);
  EXPECT_NE(first, empty);
  renderer.resize(200, 100);
  frame(many);
  renderer.resize(frame_width, frame_height);
  EXPECT_EQ(frame(many), first);
  EXPECT_EQ(frame(none), empty);
  renderer.set_options({.supersampling = 1, .light = Quality::quick, .spheres = SphereMethod::quads});
  EXPECT_NE(frame(many), first);
  renderer.set_options({.spheres = SphereMethod::compute});
  EXPECT_EQ(frame(many), first);
}

}  // namespace
}  // namespace collidoscope

// Tests the ids read back from a picture against rays cast on the CPU in double. They must agree on any
// renderer.

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <set>

#include "tests/gl_fixture.h"

namespace collidoscope {
namespace {

constexpr int buffer_width = 480, buffer_height = 360;

/// Every pixel is compared; with a sanitizer, which makes the rays slow, every third of each row and column.
#ifdef WITH_SANITIZER
constexpr int stride = 3;
#else
constexpr int stride = 1;
#endif
constexpr int compared_pixels = buffer_width * buffer_height / (stride * stride);

// Offsets of up to half a pixel. An id is compared only if all these rays agree, which excludes pixels within
// half a pixel of an outline or an intersection.
constexpr double around[9][2] = {{0, 0},       {0.5, 0},      {-0.5, 0},     {0, 0.5},      {0, -0.5},
                                 {0.36, 0.36}, {-0.36, 0.36}, {0.36, -0.36}, {-0.36, -0.36}};

std::uint32_t nearest_sphere(const EyeRay& ray, const std::vector<BodyInstance>& bodies) {
  std::uint32_t found = 0;
  double nearest = 1e300;
  for (const BodyInstance& body : bodies) {
    const Vector3d to_center = Vector3d(body.center[0], body.center[1], body.center[2]) - ray.origin;
    const double along = to_center.dot(ray.direction);
    const double inside =
        static_cast<double>(body.radius) * body.radius - (to_center - along * ray.direction).squaredNorm();
    if (inside < 0) continue;
    const double hit = along - std::sqrt(inside);
    if (hit > 0 && hit < nearest) {
      nearest = hit;
      found = body.id + 1;
    }
  }
  return found;
}

std::uint32_t nearest_box(const EyeRay& ray, const std::vector<BoxInstance>& boxes) {
  std::uint32_t found = 0;
  double nearest = 1e300;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    double from = 0, to = 1e300;
    for (int k = 0; k < 3; ++k) {
      double a = (boxes[i].min[k] - ray.origin[k]) / ray.direction[k],
             b = (boxes[i].max[k] - ray.origin[k]) / ray.direction[k];
      if (a > b) std::swap(a, b);
      from = std::max(from, a);
      to = std::min(to, b);
    }
    if (from > to || from >= nearest) continue;
    nearest = from;
    found = 0x80000000u + static_cast<std::uint32_t>(i);
  }
  return found;
}

struct Agreement {
  int compared = 0, wrong = 0;
  std::set<std::uint32_t> seen;
};

template <class Cast>
Agreement compare_ids(const std::vector<std::uint32_t>& ids, const OrbitCamera& camera, Cast cast) {
  Agreement result;
  for (int y = 0; y < buffer_height; y += stride)
    for (int x = 0; x < buffer_width; x += stride) {
      std::uint32_t expected = 0;
      bool certain = true;
      for (int k = 0; k < 9 && certain; ++k) {
        const std::uint32_t id = cast(
            eye_ray(camera, buffer_width, buffer_height, x + 0.5 + around[k][0], y + 0.5 + around[k][1]));
        if (k == 0) expected = id;
        certain = id == expected;
      }
      if (!certain) continue;
      const std::uint32_t drawn =
          ids[static_cast<std::size_t>(y) * buffer_width + static_cast<std::size_t>(x)];
      ++result.compared;
      result.wrong += drawn != expected;
      if (drawn == expected) result.seen.insert(drawn);
    }
  return result;
}

void expect_spheres_match(const TestBodies& bodies, const OrbitCamera& camera, int least_seen) {
  Renderer renderer(buffer_width, buffer_height);
  renderer.set_scene(frame_scene(bodies.scene, bodies.initial));
  renderer.instances().upload(std::span<const BodyInstance>(bodies.instances));
  const Agreement found = compare_ids(renderer.draw_ids(camera, {}), camera, [&](const EyeRay& ray) {
    return nearest_sphere(ray, bodies.instances);
  });
  EXPECT_EQ(found.wrong, 0) << "of " << found.compared << " pixels";
  EXPECT_GT(found.compared, compared_pixels / 2);
  EXPECT_GE(static_cast<int>(found.seen.size()), least_seen);
}

OrbitCamera standard_camera(const TestBodies& bodies) {
  const FrameScene scene = frame_scene(bodies.scene, bodies.initial);
  return scene_camera({}, scene.bounds, static_cast<double>(buffer_width) / buffer_height);
}

TEST(IdBuffer, SpheresAreWhereRaysFindThem) {
  test_context();
  const TestBodies bodies = test_spheres(150, 9, 1);
  expect_spheres_match(bodies, standard_camera(bodies), 60);
}

TEST(IdBuffer, SpheresAreRightInOrthographicViewToo) {
  test_context();
  const TestBodies bodies = test_spheres(150, 9, 2);
  OrbitCamera camera = standard_camera(bodies);
  camera.orthographic = true;
  expect_spheres_match(bodies, camera, 60);
}

TEST(IdBuffer, SpheresAreRightFromAmongThem) {
  test_context();
  const TestBodies bodies = test_spheres(300, 9, 3);
  OrbitCamera camera = standard_camera(bodies);
  camera.target = {50, 50, 50};
  camera.distance = 1;
  camera.field_of_view = 1.9;  // wide, so that outlines are far from circular
  expect_spheres_match(bodies, camera, 20);
}

TEST(IdBuffer, TheEyeWithinASphereSeesThroughIt) {
  test_context();
  TestBodies bodies = test_spheres(50, 9, 4);
  OrbitCamera camera = standard_camera(bodies);
  camera.target = {50, 50, 50};
  camera.distance = 20;
  bodies.initial.position.push_back(camera.eye());
  bodies.initial.radius.push_back(3);
  bodies.instances.push_back(sphere_instance(camera.eye(), 3, 0, 50));
  expect_spheres_match(bodies, camera, 8);
}

TEST(IdBuffer, DisjointBoxesOfOneLevelAreWhereRaysFindThem) {
  test_context();
  // Four levels of boxes by halving the longest side. Each box is slightly smaller than its cell, so boxes of
  // a level are disjoint.
  std::vector<std::pair<Vector3d, Vector3d>> cells{{{0, 0, 0}, {100, 90, 80}}};
  const TestBodies bodies = test_spheres(1, 5, 5);
  const OrbitCamera camera = standard_camera(bodies);
  Renderer renderer(buffer_width, buffer_height);
  renderer.set_scene(frame_scene(bodies.scene, bodies.initial));
  for (int level = 0; level < 5; ++level) {
    std::vector<BoxInstance> boxes;
    for (const auto& [low, high] : cells)
      boxes.push_back(box_instance(low + Vector3d::Constant(1), high - Vector3d::Constant(1), level));
    renderer.instances().upload(std::span<const BoxInstance>(boxes));
    const auto ids = renderer.draw_ids(camera, {.bodies = false, .boxes = true});
    const Agreement found =
        compare_ids(ids, camera, [&](const EyeRay& ray) { return nearest_box(ray, boxes); });
    EXPECT_EQ(found.wrong, 0) << "level " << level;
    EXPECT_GT(found.compared, compared_pixels * 3 / 4);
    EXPECT_GE(found.seen.size(), std::min<std::size_t>(boxes.size(), 12)) << "level " << level;

    std::vector<BoxInstance> read(boxes.size());
    renderer.instances().boxes.read(read.data(), read.size() * sizeof(BoxInstance));
    EXPECT_EQ(std::memcmp(read.data(), boxes.data(), boxes.size() * sizeof(BoxInstance)), 0);

    decltype(cells) halves;
    for (const auto& [low, high] : cells) {
      int axis = 0;
      (high - low).maxCoeff(&axis);
      Vector3d middle_low = low, middle_high = high;
      middle_low[axis] = middle_high[axis] = 0.5 * (low[axis] + high[axis]);
      halves.push_back({low, middle_high});
      halves.push_back({middle_low, high});
    }
    cells = std::move(halves);
  }
}

TEST(IdBuffer, ABoxInTheWrongPlaceIsFound) {
  test_context();
  const TestBodies bodies = test_spheres(1, 5, 6);
  const OrbitCamera camera = standard_camera(bodies);
  Renderer renderer(buffer_width, buffer_height);
  renderer.set_scene(frame_scene(bodies.scene, bodies.initial));
  const std::vector<BoxInstance> drawn{box_instance({20, 20, 20}, {60, 60, 60}, 0)};
  const std::vector<BoxInstance> expected{box_instance({20, 20, 20}, {60, 60, 64}, 0)};
  renderer.instances().upload(std::span<const BoxInstance>(drawn));
  const Agreement found = compare_ids(renderer.draw_ids(camera, {.bodies = false, .boxes = true}), camera,
                                      [&](const EyeRay& ray) { return nearest_box(ray, expected); });
  EXPECT_GT(found.wrong, 100 / (stride * stride));
}

// An orthographic view from above, four pixels per metre, so that the position of each edge is known.
TEST(IdBuffer, TheNearestEdgeOfABoxIsPicked) {
  test_context();
  TestBodies bodies = test_spheres(1, 5, 6);
  bodies.instances[0] = sphere_instance({50, 50, 90}, 5, 0, 0);
  OrbitCamera camera;
  camera.orthographic = true;
  camera.field_of_view = 1;
  camera.distance = buffer_height / 8.0 / std::tan(0.5);
  camera.target = {50, 50, 50};
  camera.elevation = std::numbers::pi / 2;
  camera.azimuth = -std::numbers::pi / 2;
  Renderer renderer(buffer_width, buffer_height);
  renderer.set_scene(frame_scene(bodies.scene, bodies.initial));
  std::vector<BoxInstance> boxes{box_instance({20, 20, 40}, {80, 80, 60}, 0),
                                 box_instance({21.75, 21.75, 45}, {50, 50, 55}, 1)};
  boxes[0].value = 7;
  boxes[1].value = 3;
  renderer.instances().upload(std::span<const BodyInstance>(bodies.instances));
  renderer.instances().upload(std::span<const BoxInstance>(boxes));
  const auto at = [&](double x, double y, IdLayers layers = {}) {
    return renderer.pick_box(camera, layers, static_cast<int>(buffer_width / 2.0 + 4 * (x - 50)),
                             static_cast<int>(buffer_height / 2.0 - 4 * (y - 50)), 6);
  };
  EXPECT_EQ(at(20, 40), 0u);
  EXPECT_EQ(at(19, 40), 0u) << "four pixels beside it";
  EXPECT_EQ(at(21.25, 40), 1u) << "the nearer of two";
  EXPECT_EQ(at(35, 35), std::nullopt) << "faces are not edges";
  EXPECT_EQ(at(50, 48), std::nullopt) << "a body hides it";
  EXPECT_EQ(at(50, 48, {.bodies = false}), 1u);
  EXPECT_EQ(at(19, 40, {.high = 5}), std::nullopt) << "what is not drawn is not picked";
  EXPECT_EQ(at(21.25, 40, {.low = 5}), 0u) << "farther off, but drawn";
  EXPECT_EQ(at(-1000, 40), std::nullopt);
}

TEST(IdBuffer, MeshBodiesAreWhereTheirFacesAre) {
  test_context();
  // A rotated regular octahedron of radius 10 between two spheres: three runs of the body array.
  TestBodies bodies = test_spheres(3, 6, 7);
  Mesh mesh;
  for (int k = 0; k < 3; ++k)
    for (double sign : {1.0, -1.0}) mesh.vertices.push_back(10 * sign * Vector3d::Unit(k));
  for (int i = 0; i < 8; ++i) {
    const std::uint32_t x = i & 1 ? 1 : 0, y = i & 2 ? 3 : 2, z = i & 4 ? 5 : 4;
    const bool swapped = ((i & 1) + (i >> 1 & 1) + (i >> 2 & 1)) % 2 != 0;
    mesh.faces.push_back(swapped ? std::array<std::uint32_t, 3>{x, z, y}
                                 : std::array<std::uint32_t, 3>{x, y, z});
  }
  bodies.initial.meshes.push_back(mesh);
  bodies.initial.mesh = {0, 1, 0};
  const Vector3d centers[3] = {{20, 30, 50}, {50, 50, 50}, {80, 60, 50}};
  for (std::uint32_t i = 0; i < 3; ++i) bodies.instances[i] = sphere_instance(centers[i], 6, 0, i);
  const Quaterniond turn = Quaterniond(0.9, 0.2, -0.3, 0.25).normalized();
  for (int k = 0; k < 4; ++k) bodies.instances[1].orientation[k] = static_cast<float>(turn.coeffs()[k]);
  bodies.instances[1].mesh = 1;
  const OrbitCamera camera = standard_camera(bodies);
  Renderer renderer(buffer_width, buffer_height);
  renderer.set_scene(frame_scene(bodies.scene, bodies.initial));
  ASSERT_EQ(renderer.scene().runs.size(), 3u);
  renderer.instances().upload(std::span<const BodyInstance>(bodies.instances));
  const std::vector<BodyInstance> spheres{bodies.instances[0], bodies.instances[2]};
  const Agreement found = compare_ids(renderer.draw_ids(camera, {}), camera, [&](const EyeRay& ray) {
    // The octahedron is |x| + |y| + |z| <= 10 in its own axes. The three bodies do not overlap in the
    // picture.
    const Vector3d origin = turn.conjugate() * (ray.origin - centers[1]),
                   direction = turn.conjugate() * ray.direction;
    double from = 0, to = 1e300;
    for (int side = 0; side < 8; ++side) {
      const Vector3d normal(side & 1 ? 1 : -1, side & 2 ? 1 : -1, side & 4 ? 1 : -1);
      const double slope = normal.dot(direction), at = (10 - normal.dot(origin)) / slope;
      if (slope < 0) from = std::max(from, at);
      if (slope > 0) to = std::min(to, at);
    }
    if (from <= to) return std::uint32_t{2};
    return nearest_sphere(ray, spheres);
  });
  EXPECT_EQ(found.wrong, 0);
  EXPECT_THAT(found.seen, testing::IsSupersetOf({0u, 1u, 2u, 3u}));
}

}  // namespace
}  // namespace collidoscope

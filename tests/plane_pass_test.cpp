// Tests planes and boxes in pictures against rays in double: position, hidden bodies, and transparency from
// behind.

#include "viewer/render/plane_pass.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <optional>

#include "tests/gl_fixture.h"

namespace collidoscope {
namespace {

constexpr int plane_width = 160, plane_height = 120;

// A valley of two slopes along y with a sphere above it. Optionally another sphere is below the planes,
// inside the obstacle.
struct Valley {
  TestBodies bodies;
  OrbitCamera camera;

  explicit Valley(bool buried) {
    bodies.scene.obstacles = {{.normal = Vector3d(1, 0, 2).normalized(), .offset = 0},
                              {.normal = Vector3d(-1, 0, 2).normalized(), .offset = 0}};
    add({-6, 0, 7});
    add({6, 0, 8});
    frame = frame_scene(bodies.scene, bodies.initial);
    if (buried) bodies.instances.push_back(sphere_instance({-5, -3, -1}, 2, 0.5, 2));
    frame.runs[0].count = static_cast<std::int64_t>(bodies.instances.size());
    camera = frame_all(frame.bounds, static_cast<double>(plane_width) / plane_height);
  }
  void add(const Vector3d& center) {
    bodies.initial.position.push_back(center);
    bodies.initial.radius.push_back(2);
    const auto id = static_cast<std::uint32_t>(bodies.instances.size());
    bodies.instances.push_back(sphere_instance(center, 2, 0.9, id));
  }
  Image draw(bool spheres, bool planes) const {
    test_context();
    Renderer renderer(plane_width, plane_height, {.supersampling = 1});
    renderer.set_scene(frame);
    renderer.instances().upload(std::span<const BodyInstance>(bodies.instances));
    renderer.draw(camera, {.spheres = spheres, .grid = planes, .overlay = false}, {0, 1});
    return renderer.read_picture();
  }

  FrameScene frame;
};

struct Hit {
  double distance = 1e300;
  double reach = 0;  ///< distance to the centre of the plane, relative to the radius at which it has faded
  double edge = 0;   ///< m to the nearest other plane
};

// The first face of the valley on a ray, from either side.
Hit first_plane(const FrameScene& scene, const EyeRay& ray) {
  Hit first;
  const double radius = 1.5 * (scene.bounds.max - scene.bounds.min).maxCoeff();
  const Vector3d center = scene.bounds.center();
  for (const Plane& plane : scene.planes) {
    const double t = (plane.offset - plane.normal.dot(ray.origin)) / plane.normal.dot(ray.direction);
    const Vector3d at = ray.origin + t * ray.direction;
    double edge = 1e300;
    for (const Plane& other : scene.planes)
      if (&other != &plane) edge = std::min(edge, other.normal.dot(at) - other.offset);
    const Vector3d middle = center + (plane.offset - plane.normal.dot(center)) * plane.normal;
    const double reach = (at - middle).norm() / radius;
    if (t > 0 && edge > 0 && t < first.distance && reach < 1) first = {t, reach, edge};
  }
  return first;
}

int difference(const Image& a, const Image& b, int x, int y) {
  int most = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t at = (static_cast<std::size_t>(y) * plane_width + static_cast<std::size_t>(x)) * 4 + k;
    most = std::max(most, std::abs(a.rgba[at] - b.rgba[at]));
  }
  return most;
}

template <class Check>
void for_each_pixel(const OrbitCamera& camera, const Check& check) {
  for (int y = 0; y < plane_height; ++y)
    for (int x = 0; x < plane_width; ++x)
      check(x, y, eye_ray(camera, plane_width, plane_height, x + 0.5, y + 0.5));
}

TEST(PlanePass, PlanesAreWhereRaysMeetThem) {
  Valley valley(false);
  for (const bool orthographic : {false, true}) {
    valley.camera.orthographic = orthographic;
    const Image with = valley.draw(false, true), without = valley.draw(false, false);
    int on = 0, off = 0;
    for_each_pixel(valley.camera, [&](int x, int y, const EyeRay& ray) {
      const Hit hit = first_plane(valley.frame, ray);
      if (hit.distance < 1e300 && hit.reach < 0.45 && hit.edge > 0.01) {
        EXPECT_GE(difference(with, without, x, y), 12) << x << ' ' << y;
        ++on;
      }
      if (hit.distance == 1e300) {
        EXPECT_EQ(difference(with, without, x, y), 0) << x << ' ' << y;
        ++off;
      }
    });
    EXPECT_GT(on, plane_width * plane_height / 5);
    EXPECT_TRUE(orthographic || off > 0);
  }
}

TEST(PlanePass, APlaneHidesWhatIsBehindIt) {
  const Valley buried(true), clear(false);
  EXPECT_EQ(buried.draw(true, true), clear.draw(true, true));
  EXPECT_FALSE(buried.draw(true, false) == clear.draw(true, false)) << "the sphere beneath is in the picture";
}

TEST(PlanePass, FromBehindAPlaneIsAVeil) {
  Valley valley(true);
  valley.camera.elevation = -0.5;
  const Image with = valley.draw(true, true), without = valley.draw(true, false);
  const auto sphere = [&](const EyeRay& ray, const BodyInstance& body) {
    const Vector3d to = Vector3d(body.center[0], body.center[1], body.center[2]) - ray.origin;
    const double along = to.dot(ray.direction), across = (to - along * ray.direction).norm();
    return across < 0.9 * body.radius ? along - std::sqrt(body.radius * body.radius - across * across)
                                      : 1e300;
  };
  int bare = 0, veiled = 0;
  for_each_pixel(valley.camera, [&](int x, int y, const EyeRay& ray) {
    const Hit hit = first_plane(valley.frame, ray);
    const double beneath = sphere(ray, valley.bodies.instances[2]);
    const double above =
        std::min(sphere(ray, valley.bodies.instances[0]), sphere(ray, valley.bodies.instances[1]));
    if (beneath < std::min(hit.distance, above)) {
      EXPECT_EQ(difference(with, without, x, y), 0) << x << ' ' << y;
      ++bare;
    } else if (hit.distance < above && above < 1e300 && hit.reach < 0.45) {
      EXPECT_GE(difference(with, without, x, y), 1) << x << ' ' << y;
      EXPECT_LE(difference(with, without, x, y), 110) << x << ' ' << y;
      ++veiled;
    }
  });
  EXPECT_GT(bare, 50);
  EXPECT_GT(veiled, 50);
}

// Distance along a ray to a box grown by `more`, m; 1e300 for a miss.
double entry(const BoxObstacle& box, const EyeRay& ray, double more) {
  const Vector3d from = box.orientation.conjugate() * Vector3d(ray.origin - box.center),
                 along = box.orientation.conjugate() * ray.direction;
  double in = 0, out = 1e300;
  for (int k = 0; k < 3; ++k) {
    const double half = box.size[k] / 2 + more;
    const double a = (-half - from[k]) / along[k], b = (half - from[k]) / along[k];
    in = std::max(in, std::min(a, b));
    out = std::min(out, std::max(a, b));
  }
  return in < out ? in : 1e300;
}

TEST(PlanePass, BoxesAreWhereRaysMeetThemAndSpheresInFrontHideThem) {
  OrbitCamera camera = frame_all({Vector3d(-7, -9, -2), Vector3d(8, 7, 9)}, 4.0 / 3);
  TestBodies bodies;
  const Vector3d inside(1, 1, 3), front = inside + 6 * (camera.eye() - inside).normalized();
  for (const Vector3d& center : {front, inside}) {
    bodies.initial.position.push_back(center);
    bodies.initial.radius.push_back(1.5);
    const auto id = static_cast<std::uint32_t>(bodies.instances.size());
    bodies.instances.push_back(sphere_instance(center, 1.5, 0.9, id));
  }
  FrameScene without = frame_scene(bodies.scene, bodies.initial), with = without;
  const BoxObstacle box{.center = Vector3d(1, 1, 3),
                        .size = Vector3d(6, 5, 4),
                        .orientation = Quaterniond(0.9, 0.1, 0.2, 0.3).normalized()};
  with.boxes = {box};
  const auto draw = [&](const FrameScene& frame) {
    test_context();
    Renderer renderer(plane_width, plane_height, {.supersampling = 1});
    renderer.set_scene(frame);
    renderer.instances().upload(std::span<const BodyInstance>(bodies.instances));
    renderer.draw(camera, {.spheres = true, .grid = true, .overlay = false}, {0, 1});
    return renderer.read_picture();
  };
  for (const bool orthographic : {false, true}) {
    camera.orthographic = orthographic;
    const Image a = draw(without), b = draw(with);
    int on = 0, changed = 0, off = 0, hidden = 0;
    for_each_pixel(camera, [&](int x, int y, const EyeRay& ray) {
      const auto across = [&](const Vector3d& center) {
        const Vector3d to = center - ray.origin;
        return (to - to.dot(ray.direction) * ray.direction).norm();
      };
      const bool meets = entry(box, ray, -0.1) < 1e300, misses = entry(box, ray, 0.1) == 1e300;
      if (across(front) < 1.3 && meets) {
        ++hidden;
        EXPECT_LE(difference(a, b, x, y), 40)
            << x << ' ' << y << ": but for the light that the box keeps off";
      } else if (meets && across(front) > 1.6) {
        ++on;
        changed += difference(a, b, x, y) > 0;
      } else if (misses && across(front) > 1.6 && across(inside) > 1.6) {
        ++off;
        EXPECT_EQ(difference(a, b, x, y), 0) << x << ' ' << y;
      }
    });
    EXPECT_GT(on, 400);
    EXPECT_GT(changed, 0.99 * on) << "but where the box looks like what is behind it";
    EXPECT_GT(off, 400);
    EXPECT_GT(hidden, 20);
  }
}

}  // namespace
}  // namespace collidoscope

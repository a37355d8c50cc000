#pragma once
// Shared parts of tests that draw: one GL context per program, synthetic records, and analytic rays.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "headless/pictures/egl_context.h"
#include "viewer/render/renderer.h"

namespace collidoscope {

/// Created at first use and kept until exit, since creating a context is slow.
inline EglContext& test_context() {
  static EglContext context;
  context.make_current();
  return context;
}

/// A small random number generator for [0, 1), equal on all machines.
class TestRandom {
 public:
  explicit TestRandom(std::uint32_t seed) : state_(seed) {}
  double operator()() {
    state_ = state_ * 1664525u + 1013904223u;
    return (state_ >> 8) * (1.0 / 16777216);
  }

 private:
  std::uint32_t state_;
};

struct TestBodies {
  Scene scene;
  InitialBodies initial;
  std::vector<BodyInstance> instances;
};

inline BodyInstance sphere_instance(const Vector3d& center, double radius, double value, std::uint32_t id) {
  BodyInstance record{};
  for (int k = 0; k < 3; ++k) record.center[k] = static_cast<float>(center[k]);
  record.radius = static_cast<float>(radius);
  record.orientation[3] = 1;
  record.value = static_cast<float>(value);
  record.id = id;
  return record;
}

/// `count` spheres of radii up to `radius_max` m in the standard box, with values from 0 to 1.
inline TestBodies test_spheres(int count, double radius_max, std::uint32_t seed) {
  TestBodies bodies;
  bodies.scene.box = Box{};
  bodies.initial.box = Box{};
  TestRandom random(seed);
  for (int i = 0; i < count; ++i) {
    const double radius = radius_max * (0.1 + 0.9 * random());
    Vector3d center;
    for (int k = 0; k < 3; ++k) center[k] = radius + random() * (100 - 2 * radius);
    bodies.initial.position.push_back(center);
    bodies.initial.radius.push_back(radius);
    bodies.instances.push_back(sphere_instance(center, radius, random(), static_cast<std::uint32_t>(i)));
  }
  return bodies;
}

inline BoxInstance box_instance(const Vector3d& min, const Vector3d& max, int level) {
  BoxInstance record{};
  for (int k = 0; k < 3; ++k) {
    record.min[k] = static_cast<float>(min[k]);
    record.max[k] = static_cast<float>(max[k]);
  }
  record.level = record.value = static_cast<float>(level);
  return record;
}

/// The ray through the point (x, y) of a picture, in pixels from the top left corner, in double.
struct EyeRay {
  Vector3d origin, direction;
};
inline EyeRay eye_ray(const OrbitCamera& camera, int width, int height, double x, double y) {
  const double tangent = std::tan(0.5 * camera.field_of_view);
  const double right = (2 * x / width - 1) * tangent * width / height, up = (1 - 2 * y / height) * tangent;
  const Matrix3d axes = camera.axes();
  if (camera.orthographic)
    return {camera.eye() + camera.distance * (axes.col(0) * right + axes.col(1) * up), -axes.col(2)};
  return {camera.eye(), (axes.col(0) * right + axes.col(1) * up - axes.col(2)).normalized()};
}

}  // namespace collidoscope

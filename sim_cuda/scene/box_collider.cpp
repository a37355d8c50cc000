#include "sim_cuda/scene/box_collider.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <numbers>
#include <numeric>

#include "sim_cuda/core/cancellation.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/philox.h"
#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/sphere_grid.h"

namespace collidoscope {
namespace {

/// Positions that `apart` tries per body before it reports that there is no room.
constexpr std::uint32_t max_tries = 32768;

/// Polls for cancellation once per 1024 iterations; k is the iteration. Throws Cancelled.
void look_now_and_then(Cancellation* cancellation, std::size_t k) {
  if (k % 1024 == 0 && cancellation != nullptr && cancellation->poll()) throw Cancelled();
}

/// The next float above or below x. x must be finite.
float next_float(float x, bool up) {
  if (x == 0) return up ? std::bit_cast<float>(1u) : -std::bit_cast<float>(1u);
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(x);
  return std::bit_cast<float>((x > 0) == up ? bits + 1 : bits - 1);
}

/// The walls in float, which the generator uses, and the exact bounds in double.
struct Walls {
  float min[3], side[3];
  double low[3], high[3];

  explicit Walls(const Box& box) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = box.min[axis];
      high[axis] = box.max[axis];
      min[axis] = static_cast<float>(box.min[axis]);
      side[axis] = static_cast<float>(box.max[axis] - box.min[axis]);
    }
  }

  /// A sphere coordinate at least `margin` (its radius, or 0) away from both walls. If rounding moves it an
  /// ulp beyond a wall, it is moved back, so that no sphere starts inside a wall.
  float place(int axis, float margin, float u) const {
    float x = min[axis] + margin + u * (side[axis] - 2 * margin);
    for (int nudge = 0; nudge < 2; ++nudge) {
      if (static_cast<double>(x) - margin < low[axis]) x = next_float(x, true);
      if (static_cast<double>(x) + margin > high[axis]) x = next_float(x, false);
    }
    return x;
  }

  Vector3d place(float margin, std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return {place(0, margin, unit_float(x)), place(1, margin, unit_float(y)),
            place(2, margin, unit_float(z))};
  }

  double volume() const { return (high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2]); }
};

[[noreturn]] void no_room(const BoxCollider& generator, const std::string& where, double fill,
                          const std::string& what) {
  throw InputError(
      fmt::format("{}.spawn: no space for {} spheres without overlap: {}, and their volume is {:.1f} % of "
                  "the box; use fewer or smaller spheres, a larger box, or spawn \"inside\"",
                  where, generator.count, what, 100 * fill));
}

/// Places the bodies in order of decreasing radius; equal radii are ordered by id. Each body gets its first
/// candidate position that is free.
/// Placing in id order fails above a fill of 25 %, because late large bodies find no room. Not even 2,000
/// spheres of U(0,5) would fit in the paper's box.
void place_apart(const BoxCollider& generator, const Walls& walls, const std::string& where,
                 std::size_t first, InitialBodies& bodies, Cancellation* cancellation) {
  double volume = 0;
  for (std::size_t i = first; i < bodies.size(); ++i) {
    const double radius = bodies.radius[i];
    volume += 4.0 / 3 * std::numbers::pi * radius * radius * radius;
  }
  const double fill = volume / walls.volume();
  if (fill >= 1) no_room(generator, where, fill, "their volume exceeds that of the box");

  SphereGrid grid(Vector3d(walls.low[0], walls.low[1], walls.low[2]),
                  Vector3d(walls.high[0], walls.high[1], walls.high[2]), largest_radius(generator),
                  bodies.size());
  for (std::size_t i = 0; i < first; ++i) grid.insert(bodies.position[i], bodies.radius[i]);

  std::vector<std::uint32_t> order(bodies.size() - first);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return bodies.radius[first + a] > bodies.radius[first + b];
  });
  const PhiloxKey key = philox_key(generator.seed);
  std::size_t placed = 0;
  for (const std::uint32_t id : order) {
    look_now_and_then(cancellation, placed++);
    const double radius = bodies.radius[first + id];
    Vector3d& position = bodies.position[first + id];
    for (std::uint32_t tries = 1; grid.overlaps(position, radius); ++tries) {
      if (tries == max_tries) {
        no_room(
            generator, where, fill,
            fmt::format("no free position for sphere {} (radius {:.3g} m) in {} tries", id, radius, tries));
      }
      const PhiloxWords r = philox4x32({{id, 1 + tries, 0, 0}}, key);
      position = walls.place(static_cast<float>(radius), r.w[0], r.w[1], r.w[2]);
    }
    grid.insert(position, radius);
  }
}

}  // namespace

double newton_cube_root(double x) {
  if (!(x > 0)) return 0;
  double y = 1;
  while (y * y * y < x) y *= 2;
  while (y * y * y >= 8 * x) y /= 2;
  for (int i = 0; i < 8; ++i) y = (2 * y + x / (y * y)) / 3;
  return y;
}

/// Mean of (r / radius_max)^3. With v uniform in (0, 1], r / radius_max is v, or (1 + 15 v^3) / 16.
constexpr double mean_cube(Radii radii) {
  constexpr double a = 1.0 / 16, b = 15.0 / 16;
  return radii == Radii::uniform ? 0.25 : a * a * a + 3 * a * a * b / 4 + 3 * a * b * b / 7 + b * b * b / 10;
}

double scaled_side(std::int64_t count, double radius_max, Radii radii) {
  const double mean_volume =
      4 * mean_cube(radii) * (std::numbers::pi / 3 * (radius_max * radius_max * radius_max));
  const double side = newton_cube_root(static_cast<double>(count) * mean_volume / scaled_fill);
  return static_cast<float>(std::max(100.0, side));
}

float equal_radius(double radius_max, Radii radii) {
  if (radii == Radii::mostly_small)
    return static_cast<float>(radius_max * newton_cube_root(mean_cube(radii)));
  // The mean of r^3 for r uniform in (0, R] is R^3 / 4. A sphere of radius R cuberoot(1/4) therefore has the
  // mean volume. cuberoot(1/4) = 2^(-2/3) = 0.62996052494743658...
  return static_cast<float>(radius_max) * 0.62996052494743658f;
}

double largest_radius(const BoxCollider& generator) {
  return generator.variant == Variant::equal ? equal_radius(generator.radius_max, generator.radii)
                                             : static_cast<float>(generator.radius_max);
}

std::optional<Box> box_in_effect(const Scene& scene) {
  std::optional<Box> box = scene.box;
  for (const BoxCollider& generator : scene.generators) {
    if (generator.variant == Variant::paper || !box) continue;
    const double side = scaled_side(generator.count, generator.radius_max, generator.radii);
    box->max = box->min + Vector3d(side, side, side);
  }
  return box;
}

bool needs_presimulation(const Scene& scene) {
  return std::ranges::any_of(scene.generators,
                             [](const BoxCollider& g) { return g.variant == Variant::settled; });
}

double greatest_radius_max(const BoxCollider& generator, const Box& box) {
  Scene scene;
  scene.box = box;
  scene.generators = {generator};
  BoxCollider& one = scene.generators[0];
  const auto fits = [&](double radius_max) {
    one.radius_max = radius_max;
    const Box in_effect = *box_in_effect(scene);
    return 2 * largest_radius(one) <= (in_effect.max - in_effect.min).minCoeff() &&
           (one.variant == Variant::paper || in_effect.max.cwiseAbs().maxCoeff() <= limits::max_coordinate);
  };
  double low = limits::min_generated_radius, high = limits::max_radius;
  if (fits(high)) return high;
  for (int k = 0; k < 100; ++k) {
    const double middle = 0.5 * (low + high);
    (fits(middle) ? low : high) = middle;
  }
  return low;
}

void append_box_collider(const BoxCollider& generator, const Box& box, const std::string& where,
                         InitialBodies& bodies, Cancellation* cancellation) {
  const std::size_t first = bodies.size(), total = first + static_cast<std::size_t>(generator.count);
  bodies.position.resize(total);
  bodies.radius.resize(total);
  if (generator.speed_max > 0) {
    bodies.velocity.resize(first, Vector3d(0, 0, 0));
    bodies.velocity.resize(total);
  }

  const Walls walls(box);
  const PhiloxKey key = philox_key(generator.seed);
  const auto radius_max = static_cast<float>(generator.radius_max);
  const auto speed_max = static_cast<float>(generator.speed_max);
  for (std::size_t i = first; i < total; ++i) {
    look_now_and_then(cancellation, i);
    const auto id = static_cast<std::uint32_t>(i - first);
    const PhiloxWords r = philox4x32({{id, 0, 0, 0}}, key);
    const float fraction = 1 - unit_float(r.w[0]);
    const float radius =
        generator.variant == Variant::equal ? equal_radius(generator.radius_max, generator.radii)
        : generator.radii == Radii::uniform ? radius_max * fraction
                                            : radius_max * ((1 + 15 * (fraction * fraction * fraction)) / 16);
    const float margin = generator.spawn == Spawn::centres ? 0 : radius;
    bodies.radius[i] = radius;
    bodies.position[i] = walls.place(margin, r.w[1], r.w[2], r.w[3]);
    if (speed_max > 0) {
      const PhiloxWords v = philox4x32({{id, 1, 0, 0}}, key);
      for (int axis = 0; axis < 3; ++axis) {
        bodies.velocity[i][axis] = speed_max * (2 * unit_float(v.w[axis]) - 1);
      }
    }
  }
  if (generator.spawn == Spawn::apart) place_apart(generator, walls, where, first, bodies, cancellation);
}

}  // namespace collidoscope

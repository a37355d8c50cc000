#pragma once
// Scenes with bodies that sleep, and which of them do.

#include <algorithm>
#include <vector>

#include "sim_cuda/run/run_state.h"
#include "sim_cuda/solver/sleeping.h"
#include "sim_cuda/world.h"
#include "tests/scenes.h"

namespace collidoscope {

/// Whether each body slept in the last step, by id.
inline std::vector<bool> bodies_asleep(World& world) {
  std::vector<bool> asleep;
  for (const std::uint32_t timer : world.state().warm_start.sleep_timer)
    asleep.push_back(timer == asleep_marker);
  return asleep;
}
inline int count_asleep(World& world, std::size_t first = 0, std::size_t last = ~std::size_t{0}) {
  const std::vector<bool> asleep = bodies_asleep(world);
  return static_cast<int>(
      std::count(asleep.begin() + static_cast<std::ptrdiff_t>(first),
                 asleep.begin() + static_cast<std::ptrdiff_t>(std::min(last, asleep.size())), true));
}

/// A floor and columns of `high` spheres of 1 m at these places, with friction and little restitution.
inline Scene sleeping_columns(const std::vector<double>& places, int high) {
  Scene scene;
  scene.physics.solver = Solver::soft_step;
  scene.physics.sleep = Sleep{};
  scene.materials[0].friction = 0.5;
  scene.materials[0].restitution = 0.2;
  scene.obstacles.push_back({});
  for (const double x : places)
    for (int k = 0; k < high; ++k) scene.bodies.push_back(sphere(1, Vector3d(x, 0, 1 + 2 * k)));
  return scene;
}

}  // namespace collidoscope

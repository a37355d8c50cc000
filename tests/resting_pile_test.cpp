// Tests that piles come to rest. A solver with few iterations needs many substeps to pass a load through all
// layers, and what it changes in each substep can keep a pile in motion.

#include <algorithm>
#include <vector>

#include "tests/executors.h"
#include "tests/random.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

class TallPile : public OnEachExecutor {};
ON_EACH_EXECUTOR(TallPile);

/// m/s
double median_speed(World& world) {
  std::vector<double> speed;
  for (const Vector3d& v : world.bodies().velocity) speed.push_back(v.norm());
  const auto middle = speed.begin() + std::ssize(speed) / 2;
  std::ranges::nth_element(speed, middle);
  return *middle;
}

/// 60 layers of 25 balls of 0.35 to 0.5 m fall in a shaft, at 30 steps per second.
Scene sixty_layers(double friction) {
  constexpr int side = 5, layers = 60;
  constexpr double cell = 1.1;
  Scene scene = empty_space();
  scene.physics.gravity = Vector3d(0, 0, -9.81);
  scene.physics.solver = Solver::soft_step;
  scene.materials[0].friction = friction;
  scene.materials[0].restitution = 0;
  Uniform uniform{Random(7u)};
  for (int c = 0; c < layers * side * side; ++c) {
    const double radius = uniform(0.35, 0.5);
    const Vector3d position{cell * (c % side + 0.5), cell * (c / side % side + 0.5),
                            0.6 + cell * (c / (side * side))};
    scene.bodies.push_back(sphere(radius, position + uniform.vector(0.04), uniform.vector(1)));
  }
  scene.box = Box{Vector3d(0, 0, 0), Vector3d(cell * side, cell * side, 1000)};
  return scene;
}

TEST_P(TallPile, ComesToRest) {
  // In physics version 18, half of the balls were faster than 8 mm/s. Single balls may roll on.
  for (const double friction : {0.0, 0.5}) {
    World world(sixty_layers(friction), options());
    world.step(300);
    EXPECT_LT(median_speed(world), 2e-4) << "m/s, friction " << friction;
    const StepStats stats = world.measure();
    EXPECT_EQ(stats.escaped + stats.non_finite, 0);
  }
}

class PaperBox : public OnEachExecutor {};
ON_EACH_EXECUTOR(PaperBox);

/// Without friction and with restitution, this takes long. Measured at the end: 2e3 J of 5e10 J, 0.3 mm/s.
TEST_P(PaperBox, ComesToRest) {
  Scene scene = box_collider(2000);
  scene.physics.solver = Solver::soft_step;
  scene.physics.substeps = 4;
  World world(scene, options());
  double most = 0;
  for (int k = 0; k < 60; ++k) {
    world.step(50);
    most = std::max(most, world.measure().kinetic_energy);
  }
  EXPECT_LT(world.measure().kinetic_energy, 1e-6 * most);
  EXPECT_LT(median_speed(world), 0.005);
}

}  // namespace
}  // namespace collidoscope

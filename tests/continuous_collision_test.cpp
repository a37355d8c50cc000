// Tests continuous collision. The clamped displacement is compared with brute force. In swarms and with
// bullets no body passes through another; without the effect some do. Where no motion is clamped, the state
// must not change.

#include "sim_cuda/dynamics/continuous_collision.h"

#include <bit>
#include <cmath>

#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

class Continuous : public OnEachExecutor {};
ON_EACH_EXECUTOR(Continuous);

/// m, distance of the straight path from `d` to `d + path` to the origin
double nearest(const Vector3d& d, const Vector3d& path) {
  const double length = path.squaredNorm();
  const double at = length > 0 ? std::clamp(-d.dot(path) / length, 0.0, 1.0) : 0;
  return (d + at * path).norm();
}

TEST(ShareOutsideCore, StopsWhereTheyTouchAndOnlyBeforeACore) {
  Uniform uniform{Random(3)};
  int cut = 0, stuck = 0;
  for (int k = 0; k < 100000; ++k) {
    const double reach = uniform(0.01, 2);
    const Vector3d d = uniform.vector(3), path = uniform.vector(6);
    const double fraction = fraction_outside_core<double>(d, path, reach);
    ASSERT_GE(fraction, 0);
    ASSERT_LE(fraction, 1);
    const bool enters = d.norm() > reach / 2 && nearest(d, path) < reach / 2;
    EXPECT_EQ(fraction < 1, enters);
    if (!enters) continue;
    ++cut;
    if (d.norm() <= reach) {
      EXPECT_EQ(fraction, 0);
      ++stuck;
      continue;
    }
    EXPECT_NEAR((d + fraction * path).norm(), reach, 1e-9 * (d.norm() + path.norm()));
    EXPECT_GE(nearest(d, fraction * path), reach * (1 - 1e-9));
  }
  EXPECT_GT(cut, 1000);
  EXPECT_GT(stuck, 30);
}

/// Small spheres at up to 1,000 m/s in a small box, and two heavy ones among them.
Scene swarm(Precision precision, bool continuous) {
  Scene scene;
  scene.name = "test";
  scene.box = Box{Vector3d(0, 0, 0), Vector3d(10, 10, 10)};
  scene.physics.precision = precision;
  scene.physics.time_step = 1.0 / 60;
  scene.physics.substeps = 1;  // so that the path of a step is straight
  scene.materials[0].restitution = 0.5;
  Uniform uniform{Random(7)};
  for (int k = 0; k < 300; ++k) {
    Body body = sphere(uniform(0.05, 0.4), Vector3d(5, 5, 5) + uniform.vector(4.5), uniform.vector(1000));
    if (k % 100 == 0) body.mass = 1e5;
    bool apart = true;
    for (const Body& other : scene.bodies)
      apart &= (other.position - body.position).norm() > other.radius + body.radius;
    if (apart) scene.bodies.push_back(body);
  }
  scene.physics.effects = Effects{.gravity = true, .continuous_collision = continuous};
  return scene;
}

/// Counts tunnelling pairs in `steps` steps of one substep: pairs apart at the start of a step whose centres
/// come within half the sum of their radii.
int passed(World& world, const Scene& scene, int steps) {
  int count = 0;
  std::vector<Vector3d> before = world.bodies().position;
  for (int k = 0; k < steps; ++k) {
    world.step();
    const std::vector<Vector3d> after = world.bodies().position;
    for (std::size_t a = 0; a < before.size(); ++a)
      for (std::size_t b = a + 1; b < before.size(); ++b) {
        const double reach = scene.bodies[a].radius + scene.bodies[b].radius;
        const Vector3d d = before[b] - before[a];
        if (d.norm() < reach) continue;
        count += nearest(d, after[b] - after[a] - d) < 0.499 * reach;
      }
    before = after;
  }
  return count;
}

// A wall correction may place a body beyond its displacement limit. A body without own motion stays there.
TEST(ClampedMotion, OfWhoStandsStillIsNone) {
  const DisplacementLimit<float> limit{Vector3f(0, 0, 0), 1};
  const std::uint32_t whole = std::bit_cast<std::uint32_t>(1.0f);
  const ClampedMotion<float> motion{&limit, &whole};
  const Vector3f still(0, 0, 0), outside(0, 0, 1.5f), back(0, 0, -1), on(0, 0, 1);
  EXPECT_EQ(motion.clamped_displacement(0, outside, still, 0.01f), still);
  EXPECT_EQ(motion.clamped_displacement(0, outside, on, 0.01f), still);
  EXPECT_EQ(motion.clamped_displacement(0, outside, back, 0.01f), Vector3f(0.01f * back));
}

TEST_P(Continuous, NobodyPassesThroughAnybodyInASwarm) {
  for (const auto& [precision, integrator] : {std::pair(Precision::f32, Integrator::semi_implicit_euler),
                                              {Precision::f64, Integrator::semi_implicit_euler},
                                              {Precision::f32, Integrator::velocity_verlet},
                                              {Precision::f64, Integrator::rk4}}) {
    Scene on = swarm(precision, true), off = swarm(precision, false);
    on.physics.integrator = off.physics.integrator = integrator;
    ASSERT_GT(on.bodies.size(), 200u);
    World held(on, options()), loose(off, options());
    EXPECT_EQ(passed(held, on, 60), 0);
    EXPECT_GT(passed(loose, off, 60), 20);  // shows that the count detects tunnelling
    EXPECT_EQ(held.measure().escaped, 0);
  }
}

TEST_P(Continuous, ABulletPassesNoSphereOfATenthOfAMetre) {
  // A light or a heavy bullet hits a row of three touching bodies. The last one touches a wall.
  for (const double bullet_mass : {0.01, 1000.0})
    for (const bool continuous : {true, false})
      for (const double offset : {0.0, 0.03, 0.06}) {
        Scene scene;
        scene.physics.gravity = Vector3d(0, 0, 0);
        scene.physics.time_step = 1.0 / 60;
        scene.materials[0].restitution = 0;
        scene.physics.effects = Effects{.continuous_collision = continuous};
        scene.obstacles.push_back(Plane{Vector3d(-1, 0, 0), -30.3, 0});
        for (const double x : {29.8, 30.0, 30.2}) scene.bodies.push_back(sphere(0.1, Vector3d(x, 0, 0)));
        Body bullet = sphere(0.02, Vector3d(0, offset, 0), Vector3d(1000, 0, 0));
        bullet.mass = bullet_mass;
        scene.bodies.push_back(bullet);
        World world(scene, options());
        int behind = 0;
        for (int k = 0; k < 10; ++k) {
          world.step();
          const std::vector<Vector3d> x = world.bodies().position;
          // The bullet may pass beside the row but not through it.
          const bool aside = std::abs(x[3].y() - x[0].y()) > 0.06;
          behind += x[3].x() > x[0].x() && !aside;
        }
        if (continuous) {
          EXPECT_EQ(behind, 0) << bullet_mass << " kg, " << offset << " m aside";
        }
      }
}

TEST_P(Continuous, IsCalledForBySpeedsThatCrossTheSmallestRadius) {
  Scene scene = empty_space();
  scene.physics.solver = Solver::soft_step;
  scene.physics.time_step = 1.0 / 60;  // 4 substeps per step
  scene.bodies = {sphere(0.1, Vector3d(0, 0, 0), Vector3d(23.9, 0, 0)), sphere(1, Vector3d(9, 0, 0))};
  EXPECT_FALSE(World(scene, options()).effects().continuous_collision);
  scene.bodies[0].velocity = Vector3d(24.1, 0, 0);
  EXPECT_TRUE(World(scene, options()).effects().continuous_collision);
  scene.physics.solver = Solver::impulse;
  EXPECT_FALSE(World(scene, options()).effects().continuous_collision);
}

TEST_P(Continuous, ChangesNothingWhereNobodyIsHeld) {
  // Slow bodies meet, and no motion is clamped. The scene has few bodies: in a crowd, more speculative
  // contacts would change the colouring.
  Scene scene = empty_space();
  scene.physics.solver = Solver::soft_step;
  scene.bodies = {sphere(1, Vector3d(0, 0, 0), Vector3d(3, 0, 0)), sphere(1, Vector3d(4, 0.5, 0))};
  scene.physics.effects = Effects{};
  World off(scene, options());
  scene.physics.effects = Effects{.continuous_collision = true};
  World on(scene, options());
  off.step(60);
  on.step(60);
  EXPECT_EQ(on.state_hash(), off.state_hash());
  EXPECT_GT(on.bodies().velocity[1].norm(), 1);
  EXPECT_GT(on.info().allocated_bytes, off.info().allocated_bytes);
}

TEST_P(Continuous, KeepsMomentum) {
  Scene scene = swarm(Precision::f64, true);
  scene.box.reset();
  scene.physics.gravity = Vector3d(0, 0, 0);
  scene.physics.effects = Effects{.continuous_collision = true};
  World world(scene, options());
  const StepStats before = world.measure();
  world.step(30);
  const StepStats after = world.measure();
  double size = 0;
  for (const Body& body : scene.bodies) size = std::max(size, body.velocity.norm() * body.mass.value_or(1));
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(after.momentum[k], before.momentum[k], 1e-9 * size);
}

}  // namespace
}  // namespace collidoscope

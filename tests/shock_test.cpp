// Tests impacts on bodies that the ground supports: of heavy bodies on light ones (solver/shock.h), and
// without restitution. Default settings.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/each_setting.h"
#include "tests/energy_scenes.h"
#include "tests/executors.h"

namespace collidoscope {
namespace {

class Shocks : public OnEachExecutor {
 protected:
  template <class Check>
  void for_each_setting(const Scene& scene, const Check& check) {
    collidoscope::for_each_setting(scene, options(), check);
  }
};
ON_EACH_EXECUTOR(Shocks);

/// Light balls one above the other on the floor, each of 1 kg and 1 m, and a heavy one that falls on them.
Scene heavy_on_column(int light, double mass, double speed, double restitution) {
  Scene scene = impact_space(restitution, g);
  for (int k = 0; k < light; ++k) scene.bodies.push_back(ball(1, 0.5, Vector3d(0, 0, 0.5 + k)));
  scene.bodies.push_back(ball(mass, 1, Vector3d(0, 0, light + 1.5), Vector3d(0, 0, -speed)));
  scene.obstacles = {Plane{}};
  return scene;
}

TEST_P(Shocks, AHeavyBallStopsOnLightOnes) {
  // Inelastic bodies on the floor stop a body of any mass at once. Without shocks, 100 kg press by 0.5 m into
  // one light ball, and by 0.8 m into two.
  for (const int light : {1, 2})
    for (const double mass : {20.0, 100.0})
      for_each_setting(heavy_on_column(light, mass, 10, 0), [&](World& world) {
        const double touching = light + 1;  // m, height of the heavy ball
        double lowest = touching;
        for (int k = 0; k < 12; ++k) {
          world.step();
          lowest = std::min(lowest, world.bodies().position.back().z());
        }
        const double most = world.scene().physics.solver == Solver::soft_step ? 0.12 * light : 0.25 * light;
        EXPECT_GT(lowest, touching - most) << light << " light balls, " << mass << " kg";
        EXPECT_LT(std::abs(world.bodies().velocity.back().z()), 0.5)
            << light << " light balls, " << mass << " kg";
      });
}

TEST_P(Shocks, ABallThatIsShotAwayDoesNotStayUnderTheHeavyOne) {
  // It is faster than its radius per substep, and the heavy ball presses it down again after each bounce. If
  // it stays where it is until the end of the substep, 20 of these 44 runs overlap by up to 0.15 m.
  for (const double offset : {0.1, 0.28, 0.34, 0.46})
    for (int phase = 0; phase < 11; ++phase) {
      Scene scene = impact_space(1, g);
      scene.bodies = {ball(1, 0.5, Vector3d(0, 0, 0.5)),
                      ball(89, 1, Vector3d(offset, 0, 2 + 0.04 * phase), Vector3d(0, 0, -9.8))};
      scene.obstacles = {Plane{}};
      scene.physics.time_step = TimeStep::per_second(30);
      World world(scene, options());
      double deepest = 0;
      for (int k = 0; k < 6; ++k) {
        world.step();
        deepest = std::max(deepest, static_cast<double>(world.measure().max_penetration));
      }
      EXPECT_LT(deepest, 0.05) << offset << ' ' << phase;  // m
    }
}

TEST_P(Shocks, TheGroundGivesTheImpulse) {
  // Change of momentum = impulse of gravity + impulse of planes.
  for (const int seed : {1, 4, 8})
    for (const double restitution : {0.0, 0.6}) {
      Uniform uniform{Random(static_cast<std::uint32_t>(seed))};
      Scene scene = heavy_on_pile(uniform);
      scene.materials[0].restitution = restitution;
      scene.bodies.back().mass = 500;
      double mass = 0, speed = 0;
      for (const Body& body : scene.bodies) mass += *body.mass;
      for_each_setting(scene, [&](World& world) {
        const StepStats start = world.measure();
        for (int k = 0; k < 60; ++k) {
          world.step();
          const StepStats now = world.measure();
          speed = std::max(speed, std::sqrt(2 * now.kinetic_energy / mass));
          const double size =
              mass * speed * (world.scene().physics.precision == Precision::f32 ? 2e-5 : 1e-12);
          for (int axis = 0; axis < 3; ++axis)
            ASSERT_NEAR(now.momentum[axis] - start.momentum[axis],
                        now.wall_impulse_vector[axis] + mass * world.time() * scene.physics.gravity[axis],
                        size)
                << "seed " << seed << ", state " << k << ", axis " << axis;
        }
        EXPECT_GT(world.measure().wall_impulse, 500 * 5);
      });
    }
}

TEST_P(Shocks, HeavyBallsInFreeSpaceKeepTheirMomentum) {
  // A light ball between two heavy ones, and heavy balls in clusters, far from a plane.
  std::vector<Scene> scenes{impact_space(0), impact_space(0.7), impact_space(1)};
  for (Scene& scene : scenes)
    scene.bodies = {ball(1000, 1, Vector3d(-3, 0, 0), Vector3d(5, 0, 0)), ball(1, 0.5, Vector3d(0, 0.1, 0)),
                    ball(3000, 1, Vector3d(3, 0, 0.2), Vector3d(-5, 0, 0))};
  for (int seed = 0; seed < 6; ++seed) {
    Uniform uniform{Random(static_cast<std::uint32_t>(seed))};
    scenes.push_back(ball_cluster(uniform, uniform(0, 1), 1e4));
  }
  for (Scene& scene : scenes) {
    scene.obstacles = {Plane{Vector3d(0, 0, 1), -1000, 0}};
    for_each_setting(scene, [&](World& world) {
      const StepStats before = world.measure();
      world.step(120);
      const StepStats after = world.measure();
      double size = 0;
      for (const Body& body : scene.bodies) size += *body.mass * 10;
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(after.momentum[axis], before.momentum[axis],
                    size * (world.scene().physics.precision == Precision::f32 ? 1e-6 : 1e-14));
      EXPECT_EQ(after.wall_impulse, 0);
    });
  }
}

TEST_P(Shocks, AnElasticHeavyBallReboundsAndGainsNoEnergy) {
  for (const double mass : {20.0, 1e4})
    for_each_setting(heavy_on_column(1, mass, 10, 1), [&](World& world) {
      const double start = world.measure().energy();
      double fastest = 0, largest = 0;
      for (int k = 0; k < 60; ++k) {
        world.step();
        const StepStats now = world.measure();
        fastest = std::max(fastest, world.bodies().velocity.back().z());
        largest = std::max(largest, now.energy() - now.push_work);
      }
      EXPECT_GT(fastest, 9) << mass;  // it hits the light ball at 10.4 m/s
      EXPECT_LE(largest, start + 1e-3 * mass * 50) << mass;
    });
}

TEST_P(Shocks, LightBallsThatCanGiveWayDo) {
  // The heavy ball pushes two light balls apart on a floor without friction. Its energy changes only by
  // theirs, and by what the inelastic impacts take: less than theirs.
  Scene scene = impact_space(0, 0);
  scene.bodies = {ball(1, 0.5, Vector3d(-0.6, 0, 0.5)), ball(1, 0.5, Vector3d(0.6, 0, 0.5)),
                  ball(1000, 1, Vector3d(0, 0, 3), Vector3d(0, 0, -5))};
  scene.obstacles = {Plane{}};
  for_each_setting(scene, [&](World& world) {
    for (int k = 0; k < 40 && world.bodies().position[2].z() > 1.3; ++k) world.step();
    const BodyStates states = world.bodies();
    EXPECT_LT(states.velocity[2].z(), -4.9);
    EXPECT_GT(states.velocity[1].x(), 5);
  });
}

/// Falls without restitution on the ground, and on bodies on the ground. What a stop leaves for the next
/// substep must not throw bodies up. Newton's law says 0 m/s. Largest speeds of 218 heights: in versions up
/// to 14, 0.4 to 1.2 m/s.
TEST_P(Shocks, InelasticFallsDoNotRebound) {
  struct Fall {
    int at_rest, falling;            // balls of 1 m on top of each other
    double soft_step, jacobi_split;  // m/s, bounds
  };
  for (const Fall& fall :
       {Fall{1, 1, 0.02, 0.02}, Fall{3, 1, 0.05, 0.05}, Fall{1, 2, 0.02, 0.02}, Fall{0, 3, 0.04, 0.04}})
    for (int k = 0; k < 44; ++k) {
      Scene scene = impact_space(0, g);
      scene.physics.time_step = TimeStep::per_second(60);
      scene.physics.precision = k % 2 == 0 ? Precision::f32 : Precision::f64;
      scene.box = Box{Vector3d(-3, -3, 0), Vector3d(3, 3, 40)};
      const double height = 0.05 + 0.125 * k;
      for (int body = 0; body < fall.at_rest + fall.falling; ++body)
        scene.bodies.push_back(
            ball(500, 0.5, Vector3d(0, 0, 0.5 + body + (body < fall.at_rest ? 0 : height))));
      for (const Solver solver : {Solver::soft_step, Solver::jacobi_split}) {
        scene.physics.solver = solver;
        World world(scene, options());
        double fastest = 0;
        for (int step = 0; step < 130; ++step) {
          world.step();
          for (const Vector3d& velocity : world.bodies().velocity) fastest = std::max(fastest, velocity.z());
        }
        EXPECT_LE(fastest, solver == Solver::soft_step ? fall.soft_step : fall.jacobi_split)
            << fall.falling << " on " << fall.at_rest << ", " << height << " m, "
            << name_of(solver_names, solver);
        EXPECT_LT(world.measure().kinetic_energy, 0.5) << height;  // J, of up to 80 kJ
      }
    }
}

}  // namespace
}  // namespace collidoscope

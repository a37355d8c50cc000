// Tests impacts of soft_step and jacobi_split at default settings against known results: energies, speeds,
// Newton's law of impact, Coulomb's law, rebound heights, and piles that come to rest.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/each_setting.h"
#include "tests/executors.h"
#include "tests/impact_scenes.h"

namespace collidoscope {
namespace {

double energy_tolerance(const World& world) {
  return world.scene().physics.precision == Precision::f32 ? 1e-3 : 1e-4;
}

class Impacts : public OnEachExecutor {
 protected:
  template <class Check>
  void for_each_setting(const Scene& scene, const Check& check, bool half = false) {
    collidoscope::for_each_setting(scene, options(), check, half);
  }
  /// The energy after each step must be the initial one. No body may leave the box.
  void expect_same_energy(const Scene& scene, int steps, int every = 1, bool half = false) {
    const auto check = [&](World& world) {
      const double start = world.measure().energy(), tolerance = energy_tolerance(world);
      for (int k = 0; k < steps; k += every) {
        world.step(every);
        const StepStats now = world.measure();
        ASSERT_NEAR(now.energy() / start, 1, tolerance) << "step " << now.step;
        ASSERT_EQ(now.escaped, 0) << "step " << now.step;
      }
    };
    for_each_setting(scene, check, half);
  }
};
ON_EACH_EXECUTOR(Impacts);

// ---- elastic impacts of many bodies ----

TEST_P(Impacts, ACueBallHitsTwoTouchingBalls) {
  Scene scene = impact_space(1);
  const double r = 0.1;
  scene.bodies = {ball(1, r, Vector3d(-std::sqrt(3.0) * r - 0.3, 0, 0), Vector3d(2, 0, 0)),
                  ball(1, r, Vector3d(0, r, 0)), ball(1, r, Vector3d(0, -r, 0))};
  expect_same_energy(scene, 60);
}

TEST_P(Impacts, ARackKeepsItsEnergy) {
  for (const double gap : {0.0, 1e-4})
    for (const int rate : {60, 240, 1000}) {
      SCOPED_TRACE(std::to_string(gap) + " m, " + std::to_string(rate) + "/s");
      expect_same_energy(billiard_rack(gap, 1, rate), rate / 2);
    }
}

/// The impact passes through all balls in its substep, so that no ball moves into another one.
TEST_P(Impacts, ARackDoesNotOverlap) {
  for (const double gap : {0.0, 5e-5})
    for_each_setting(billiard_rack(gap, 1, 60), [&](World& world) {
      for (int k = 0; k < 30; ++k) {
        world.step();
        ASSERT_LE(world.measure().max_penetration, 1e-7) << gap << " m, step " << world.steps();
      }
    });
}

TEST_P(Impacts, ACradleOfTouchingBallsPassesOnItsSpeeds) {
  for (const int incoming : {1, 2})
    for_each_setting(row_of_balls(5, incoming), [&](World& world) {
      world.step(60);
      const BodyStates states = world.bodies();
      for (int i = 0; i < 5; ++i) {
        const double expected = i >= 5 - incoming ? 2 : 0;
        EXPECT_NEAR(states.velocity[static_cast<std::size_t>(i)].x(), expected, energy_tolerance(world))
            << incoming << " in, ball " << i;
      }
    });
}

TEST_P(Impacts, ADenseGasKeepsItsEnergy) {
  Uniform uniform{Random(5)};
  Scene scene = gas_lattice(uniform, 1000, 0.2, 3, 1);
  expect_same_energy(scene, 150, 5);
}

TEST_P(Impacts, ADenseGasKeepsItsEnergyAtSmallSteps) {
  Uniform uniform{Random(5)};
  Scene scene = gas_lattice(uniform, 1000, 0.2, 3, 1);
  scene.physics.time_step = TimeStep::per_second(1000);
  expect_same_energy(scene, 1000, 20, true);
}

TEST_P(Impacts, AClosedGasKeepsItsEnergy) {
  expect_same_energy(project_scene("hard/closed_gas"), 15600, 40, true);
}

TEST_P(Impacts, BulletsInABoxKeepTheirEnergy) {
  expect_same_energy(project_scene("hard/bullets_in_box"), 240);
}

TEST_P(Impacts, ClustersNeverGainEnergy) {
  for (const double restitution : {1.0, 0.9, 0.5, 0.0}) {
    Uniform uniform{Random(1)};
    for (int k = 0; k < 25; ++k) {
      const Scene scene = ball_cluster(uniform, restitution, 10);
      SCOPED_TRACE("e " + std::to_string(restitution) + ", cluster " + std::to_string(k));
      for_each_setting(scene, [&](World& world) {
        const double start = world.measure().energy();
        for (int step = 0; step < 120; step += 4) {
          world.step(4);
          ASSERT_LE(world.measure().energy(), (1 + 1e-3) * start) << "step " << world.steps();
        }
        if (restitution < 1) return;
        EXPECT_NEAR(world.measure().energy() / start, 1, energy_tolerance(world));
      });
    }
  }
}

TEST_P(Impacts, ClustersKeepTheirMomenta) {
  for (const double friction : {0.0, 0.5})
    for (int k = 0; k < 10; ++k) {
      Uniform uniform{Random(static_cast<std::uint32_t>(k))};
      Scene scene = ball_cluster(uniform, uniform(0, 1), 10);
      scene.materials[0].friction = friction;
      for_each_setting(scene, [&](World& world) {
        const StepStats before = world.measure();
        world.step(120);
        const StepStats after = world.measure();
        // The sums are 2 to 10 kg m/s, and up to 30 kg m^2/s about the origin.
        const double tolerance = world.scene().physics.precision == Precision::f32 ? 2e-5 : 1e-13;
        for (int axis = 0; axis < 3; ++axis) {
          EXPECT_NEAR(after.momentum[axis], before.momentum[axis], 10 * tolerance) << k;
          // Without friction nothing turns. The arms of the normal impulses are exact to rounding.
          EXPECT_NEAR(after.angular_momentum[axis], before.angular_momentum[axis], 300 * tolerance) << k;
        }
      });
    }
}

TEST_P(Impacts, ImpactsBeyondTheLastSweepAreCounted) {
  // At half of the volume, balls at 10 m/s have chains of impacts in each substep. What the last sweep leaves
  // is inelastic.
  for (const double fill : {0.05, 0.5}) {
    Uniform uniform{Random(5)};
    for_each_setting(gas_lattice(uniform, 125, fill, 10, 1), [&](World& world) {
      const double start = world.measure().energy();
      std::int64_t beyond = 0;
      for (int k = 0; k < 60; ++k) {
        world.step();
        const StepStats now = world.measure();
        beyond += now.bounce_cap;
        EXPECT_LE(now.energy(), (1 + 1e-5) * start) << now.step;
      }
      EXPECT_EQ(beyond > 0, fill == 0.5) << beyond << " substeps";
    });
  }
}

// ---- Newton's law ----

/// Checks the impact of balls 0 and 1 of a world against Newton's law. The line of the impulse is the
/// direction of the change of velocity.
void expect_newton(World& world, double restitution) {
  const std::vector<double>& mass = world.initial().mass;
  const std::vector<Vector3d> before = world.bodies().velocity;
  world.step(30);
  const std::vector<Vector3d> after = world.bodies().velocity;
  const Vector3d change = after[1] - before[1];
  ASSERT_GT(change.norm(), 0) << "they meet";
  const Vector3d line = change.normalized();
  const double approach = (before[0] - before[1]).dot(line), separation = (after[1] - after[0]).dot(line);
  const double scale = before[0].norm() + before[1].norm();
  const double tolerance = world.scene().physics.precision == Precision::f32 ? 1e-5 : 1e-12;
  EXPECT_NEAR(separation, restitution * approach, tolerance * scale);
  EXPECT_NEAR((mass[0] * (after[0] - before[0]) + mass[1] * change).norm(), 0,
              tolerance * scale * (mass[0] + mass[1]));
}

TEST_P(Impacts, EachImpactFollowsNewtonsLaw) {
  Uniform uniform{Random(2)};
  for (int k = 0; k < 40; ++k) {
    const double restitution = one_of(uniform, {1.0, 0.0, uniform(0, 1)}), speed = random_ratio(uniform, 30);
    Scene scene = impact_space(restitution);
    const Vector3d way = random_direction(uniform), aside = way.cross(random_direction(uniform)).normalized();
    const double r = uniform(0.2, 1), sum = 0.5 + r, drift = uniform(-2, 2);
    // With restitution 0, balls that touch aside then slide about each other along a turning line.
    const double offset = restitution == 0 ? 0 : one_of(uniform, {0.0, uniform(0, 0.9)});
    scene.bodies = {
        ball(random_ratio(uniform, 1e3), 0.5, Vector3d(0, 0, 0), (speed + drift) * way),
        ball(random_ratio(uniform, 1e3), r, (sum + 0.4 * speed) * way + offset * sum * aside, drift * way)};
    SCOPED_TRACE("pair " + std::to_string(k) + ", e " + std::to_string(restitution));
    for_each_setting(scene, [&](World& world) { expect_newton(world, restitution); });
  }
}

TEST_P(Impacts, APairHasTheLargerRestitution) {
  for (const double e_a : {0.0, 0.5, 1.0})
    for (const double e_b : {0.0, 0.3, 0.8}) {
      Scene scene = impact_space(e_a);
      scene.materials.push_back({"other"});
      scene.materials[1].restitution = e_b;
      scene.bodies = {ball(1, 0.5, Vector3d(0, 0, 0), Vector3d(3, 0, 0)),
                      ball(2, 0.5, Vector3d(2.1, 0, 0), Vector3d(-1, 0, 0))};
      scene.bodies[1].material = 1;
      for_each_setting(scene, [&](World& world) { expect_newton(world, std::max(e_a, e_b)); });
    }
}

Scene falling_ball(double restitution, double height) {
  Scene scene = impact_space(restitution, g);
  scene.bodies = {ball(1, 0.1, Vector3d(0, 0, height + 0.1))};
  scene.obstacles = {Plane{}};
  return scene;
}

TEST_P(Impacts, AnElasticBallReturnsToItsHeight) {
  expect_same_energy(falling_ball(1, 1), 600);
  for_each_setting(falling_ball(1, 1), [&](World& world) {
    const double dt = world.scene().physics.time_step, tolerance = energy_tolerance(world);
    double highest = 1;
    for (int k = 0; k < 600; ++k) {
      const double before = world.bodies().velocity[0].z();
      world.step();
      const double height = world.bodies().position[0].z() - 0.1;
      highest = std::max(highest, height);
      if (before > 0 || world.bodies().velocity[0].z() < 0) continue;
      // It bounced. The highest state of the last flight lies within dt/2 of the apex.
      EXPECT_LE(highest, 1 + tolerance) << k;
      EXPECT_GE(highest, 1 - g * dt * dt / 8 - tolerance) << k;
      highest = 0;
    }
  });
}

TEST_P(Impacts, ABallReboundsToTheSquareOfItsRestitution) {
  // As long as it arrives faster than 4 g h; a slower one may come to rest.
  for (const double restitution : {0.2, 0.5, 0.8})
    for (const double height : {0.6, 1.0, 1.7}) {
      Scene scene = falling_ball(restitution, height);
      scene.physics.time_step = TimeStep::per_second(120);
      scene.physics.substeps = 1;
      for_each_setting(scene, [&](World& world) {
        double expected = height, arrives = std::sqrt(2 * g * height), before = 0;
        for (int k = 0; k < 960 && arrives > 4 * g / 120; ++k) {
          world.step();
          const double v = world.bodies().velocity[0].z(), z = world.bodies().position[0].z() - 0.1;
          if (before <= 0 && v > 0) {
            expected *= restitution * restitution;
            EXPECT_NEAR(z + v * v / (2 * g), expected, 0.02 * expected)
                << restitution << ' ' << height << ' ' << k;
            arrives *= restitution;
          }
          before = v;
        }
        EXPECT_LE(arrives, 4 * g / 120)
            << "it bounces each time; e " << restitution << ", " << height << " m";
      });
    }
}

TEST_P(Impacts, ABallComesToRestInTime) {
  // Infinitely many bounces end at sqrt(2 H / g) (1 + e) / (1 - e) = 1.3546 s.
  for_each_setting(falling_ball(0.5, 1), [&](World& world) {
    double rest = 0;  // time of the first state from which it is at rest
    for (int k = 0; k < 60; ++k) {
      world.step();
      const double v = world.bodies().velocity[0].z(), z = world.bodies().position[0].z() - 0.1;
      if (std::abs(v) > 1e-3 || z > 1e-3) rest = (k + 2) / 30.0;
    }
    EXPECT_NEAR(rest, 3 * std::sqrt(2 / g), 1.0 / 30);
  });
}

TEST_P(Impacts, ABallOnABallFliesFasterThanItFell) {
  // A basketball with a tennis ball above it falls from 1 m. Two impacts, one after the other.
  const double fall = std::sqrt(2 * g), meets = fall / g;
  Scene scene = impact_space(1, g);
  scene.bodies = {ball(0.6, 0.12, Vector3d(0, 0, 1.12)), ball(0.06, 0.033, Vector3d(0, 0, 1.274))};
  scene.obstacles = {Plane{}};
  const double center = (0.6 - 0.06) * fall / 0.66;
  for_each_setting(scene, [&](World& world) {
    world.step(static_cast<int>(std::lround((meets + 0.1) * 30)));
    const double since = world.time() - meets;
    const double lower = world.bodies().velocity[0].z() + g * since,
                 upper = world.bodies().velocity[1].z() + g * since;
    const double exact_lower = center - 0.06 * 2 * fall / 0.66, exact_upper = center + 0.6 * 2 * fall / 0.66;
    EXPECT_NEAR(lower, exact_lower, 0.04 * exact_lower) << "2.82 m/s";
    EXPECT_NEAR(upper, exact_upper, 0.04 * exact_upper) << "11.68 m/s";
  });
}

class ImpactPiles : public Impacts {
 protected:
  /// Runs 30 s. jacobi_split converges more slowly, and a few bodies keep moving.
  void expect_rest(Scene scene, std::initializer_list<Solver> solvers) {
    for (const Solver solver : solvers) {
      scene.physics.solver = solver;
      SCOPED_TRACE(name_of(solver_names, solver));
      World world(scene, options());
      double most = 0;
      for (int k = 0; k < 30; ++k) {
        world.step(30);
        most = std::max(most, world.measure().kinetic_energy);
      }
      const bool split = solver == Solver::jacobi_split;
      EXPECT_LT(world.measure().kinetic_energy, (split ? 1e-4 : 1e-7) * most);
      EXPECT_LT(world.measure().max_speed, split ? 0.5 : 0.05);
      EXPECT_EQ(world.measure().escaped, 0);
    }
  }
};
ON_EACH_EXECUTOR(ImpactPiles);

TEST_P(ImpactPiles, ComeToRest) {
  for (const double restitution : {0.2, 0.8, 0.95}) {
    SCOPED_TRACE(restitution);
    Uniform uniform{Random(5)};
    expect_rest(falling_pile(uniform, 100, 4, restitution), {Solver::soft_step, Solver::jacobi_split});
  }
}

TEST_P(ImpactPiles, AColumnOf60LayersComesToRest) {
  // One iteration of jacobi_split cannot carry so many layers.
  Uniform uniform{Random(5)};
  expect_rest(falling_pile(uniform, 540, 3, 0.2), {Solver::soft_step});
}

// ---- friction ----

TEST_P(Impacts, FrictionAtAPlaneFollowsCoulombsLaw) {
  // With the normal speed u, slip s and restitution e, the normal impulse is (1 + e) m u. Friction stops the
  // slip with the impulse 2/7 m s (a sphere), or slides with mu (1 + e) m u.
  const double r = 0.3, m = 2, down = 4;
  for (const double mu : {0.1, 0.4, 1.0})
    for (const double e : {0.0, 0.6, 1.0})
      for (const double along : {0.0, 3.0})
        for (const double spin : {-60.0, -5.0, 0.0, 12.0}) {
          Scene scene = impact_space(e);
          scene.materials[0].friction = mu;
          scene.obstacles = {Plane{}};
          scene.bodies = {ball(m, r, Vector3d(0, 0, r + 1.03), Vector3d(along, 0, -down))};
          scene.bodies[0].angular_velocity = Vector3d(0, spin, 0);
          const double slip = along - r * spin, most = mu * (1 + e) * m * down;
          const double impulse = std::clamp(-2.0 / 7 * m * slip, -most, most);
          for_each_setting(scene, [&](World& world) {
            world.step(20);
            const BodyStates states = world.bodies();
            const double tolerance = world.scene().physics.precision == Precision::f32 ? 2e-5 : 1e-12;
            const std::string label = "mu " + std::to_string(mu) + ", e " + std::to_string(e) + ", v " +
                                      std::to_string(along) + ", spin " + std::to_string(spin);
            EXPECT_NEAR(states.velocity[0].z(), e * down, tolerance * down) << label;
            EXPECT_NEAR(states.velocity[0].x(), along + impulse / m, tolerance * 20) << label;
            EXPECT_NEAR(states.angular_velocity[0].y(), spin - impulse * r / (0.4 * m * r * r),
                        tolerance * 60)
                << label;
          });
        }
}

TEST_P(Impacts, FrictionOfTwoBallsFollowsCoulombsLaw) {
  // Head on, one spinning: equal balls stop their slip with the impulse m s / 7. Before they touch, the
  // impulse acts midway between them: its arms are up to u h / 2 longer than the radius.
  const double r = 0.3, m = 2, speed = 4, longer = speed / 120 / 2 / r;
  for (const double mu : {0.05, 0.3, 2.0})
    for (const double e : {0.3, 0.6, 1.0})
      for (const double spin : {-60.0, 5.0}) {
        Scene scene = impact_space(e);
        scene.materials[0].friction = mu;
        scene.bodies = {ball(m, r, Vector3d(0, 0, 0), Vector3d(speed, 0, 0)),
                        ball(m, r, Vector3d(1.43, 0, 0))};
        scene.bodies[0].angular_velocity = Vector3d(0, spin, 0);
        const double slip = -r * spin;  // of ball 0's surface at the contact, along z
        const double most = mu * (1 + e) * m / 2 * speed, impulse = std::clamp(m * slip / 7, -most, most);
        for_each_setting(scene, [&](World& world) {
          world.step(20);
          const BodyStates states = world.bodies();
          const double rounding = world.scene().physics.precision == Precision::f32 ? 2e-5 : 1e-12;
          const double tolerance =
              std::abs(impulse) < most ? longer * std::abs(impulse) : rounding * m * speed;
          SCOPED_TRACE("mu " + std::to_string(mu) + ", e " + std::to_string(e) + ", spin " +
                       std::to_string(spin));
          EXPECT_NEAR(states.velocity[1].x() - states.velocity[0].x(), e * speed, rounding * 20);
          EXPECT_NEAR(m * states.velocity[1].z(), impulse, tolerance);
          EXPECT_NEAR(m * states.velocity[0].z(), -impulse, tolerance);
          const double turn = states.velocity[1].z() * r / (0.4 * r * r);
          EXPECT_NEAR(states.angular_velocity[0].y(), spin + turn, longer * std::abs(turn) + rounding * 60);
          EXPECT_NEAR(states.angular_velocity[1].y(), turn, longer * std::abs(turn) + rounding * 60);
        });
      }
}

}  // namespace
}  // namespace collidoscope

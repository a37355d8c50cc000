// Tests pendulums, ropes, struts and springs against closed forms, on every executor.

#include <cmath>
#include <numbers>

#include "sim_cuda/core/series.h"
#include "tests/executors.h"
#include "tests/gravity.h"
#include "tests/joint_scenes.h"

namespace collidoscope {
namespace {

using std::numbers::pi;

class Jointed : public OnEachExecutor {};
ON_EACH_EXECUTOR(Jointed);

/// The complete elliptic integral of the first kind, by its power series: k = sin(amplitude / 2).
double elliptic(double k) {
  double sum = 0, factor = 1;
  for (int n = 0; n < 4000; ++n) {
    sum += factor * factor;
    factor *= k * (2.0 * n + 1) / (2.0 * n + 2);
  }
  return sum * pi / 2;
}

TEST(Series, AgreeWithLibm) {
  for (double x = -0.01; x > -50; x -= 0.37) {
    EXPECT_NEAR(expm1_series(x), std::expm1(x), 1e-13) << x;
    EXPECT_NEAR(expm1_series(x * 1e-9) / std::expm1(x * 1e-9), 1, 1e-13) << x;
  }
  EXPECT_EQ(expm1_series(0), 0);
  EXPECT_EQ(expm1_series(-1e300), -1);
  for (double x = -2; x <= 2; x += 0.01) {
    EXPECT_NEAR(cosine_sine(x).cosine, std::cos(x), 4e-16) << x;
    EXPECT_NEAR(cosine_sine(x).sine, std::sin(x), 4e-16) << x;
  }
}

struct Swing {
  double period, worst_energy, last_energy, worst_error,
      worst_angle;  ///< energies relative to the swing energy
};

/// Ten periods of a sphere of 0.3 m, 1 m from the pivot, released at `amplitude`.
Swing swing(JointKind kind, double amplitude, int substeps, Precision precision, const RunOptions& options) {
  Scene scene = joint_space(g, precision);
  scene.physics.substeps = substeps;
  const Vector3d start(std::sin(amplitude), 0, -std::cos(amplitude));
  scene.bodies = {sphere(0.3, start)};
  scene.bodies[0].mass = 2;
  Joint joint = joint_to_world(kind, 0, Vector3d(0, 0, 0));
  if (kind != JointKind::distance) {
    joint.anchor_a = -start;
    joint.axis = Vector3d(0, 1, 0);
  }
  scene.joints = {joint};
  World world(scene, options);
  EXPECT_EQ(world.effects().rotation, kind != JointKind::distance) << "rods between centres turn nothing";
  EXPECT_TRUE(world.effects().joints);
  const double energy = world.measure().energy(), scale = 2 * g * (1 - std::cos(amplitude));
  const double dt = scene.physics.time_step;
  Swing seen{};
  double before = start.x(), first = 0, last = 0;
  int crossings = 0;
  for (int k = 1; crossings < 11 && k < 10000; ++k) {
    world.step();
    const double x = world.bodies().position[0].x();
    if (k > 1 && before > 0 && x <= 0) {
      last = (k - 1 + before / (before - x)) * dt;
      if (crossings++ == 0) first = last;
    }
    before = x;
    const StepStats stats = world.measure();
    seen.last_energy = (stats.energy() - energy) / scale;
    seen.worst_energy = std::max(seen.worst_energy, std::abs(seen.last_energy));
    seen.worst_error = std::max(seen.worst_error, stats.max_joint_error);
    seen.worst_angle = std::max(seen.worst_angle, stats.max_joint_angle);
  }
  seen.period = (last - first) / 10;
  return seen;
}

TEST_P(Jointed, PendulumsKeepTheirPeriodAndEnergy) {
  for (const JointKind kind : {JointKind::distance, JointKind::ball, JointKind::hinge})
    for (const double amplitude : {0.05, 1.5, 2.8}) {
      // A sphere that rotates with the rod is a physical pendulum: I + m l^2.
      const double length = kind == JointKind::distance ? 1 : 1 + 0.4 * 0.09;
      const double expected = 4 * std::sqrt(length / g) * elliptic(std::sin(amplitude / 2));
      for (const int substeps : {4, 8}) {
        const double h = 1.0 / 60 / substeps, w = std::sqrt(g / length);
        const Swing seen = swing(kind, amplitude, substeps, Precision::f64, options());
        // Second order: Euler's error is (w h)^2 / 24, and larger near the upright position.
        EXPECT_NEAR(seen.period / expected, 1, 0.25 * h * w * h * w) << amplitude << ' ' << substeps;
        // The initial half kick makes the energy oscillate by h w / 2. It does not drift over ten periods.
        EXPECT_LT(seen.worst_energy, 0.55 * h * w) << amplitude << ' ' << substeps;
        EXPECT_LT(seen.worst_error, kind == JointKind::distance ? 1e-6 : 1e-5);
        EXPECT_LT(seen.worst_angle, 1e-9);
      }
      const double h = 1.0 / 240, w = std::sqrt(g / length);
      const Swing rough = swing(kind, amplitude, 4, Precision::f32, options());
      EXPECT_NEAR(rough.period / expected, 1, 0.25 * h * w * h * w + 2e-5) << amplitude;
      EXPECT_LT(rough.worst_energy, 0.55 * h * w + 1e-3) << amplitude;
    }
}

TEST_P(Jointed, PendulumEnergyDoesNotDrift) {
  // The mean energy over ten periods does not depend on the phase of the oscillation. Over 100 periods no
  // energy is lost.
  Scene scene = joint_space(g);
  scene.bodies = {sphere(0.3, Vector3d(1, 0, 0))};
  scene.joints = {joint_to_world(JointKind::distance, 0, Vector3d(0, 0, 0))};
  World world(scene, options());
  const auto mean = [&] {
    double sum = 0;
    for (int k = 0; k < 1420; ++k) {  // ten periods of 2.3680 s
      world.step();
      sum += world.measure().energy();
    }
    return sum / 1420;
  };
  const double first = mean();
  world.step(14200 - 2 * 1420);
  EXPECT_NEAR(mean(), first, 1e-5 * 4 / 3 * pi * 0.027 * 1000 * g);
}

TEST_P(Jointed, ARopeIsSlackUntilItIsTaut) {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    Scene scene = joint_space(g, precision);
    scene.physics.integrator = Integrator::semi_implicit_euler;
    scene.bodies = {sphere(0.2, Vector3d(0, 0, -0.5))};
    Joint rope = joint_to_world(JointKind::distance, 0, Vector3d(0, 0, 0));
    rope.max_length = 2;
    scene.joints = {rope};
    World world(scene, options());
    const int falling = static_cast<int>(std::sqrt(2 * 1.5 / g) * 60);
    for (int k = 1; k <= falling; ++k) {
      world.step();
      const double t = k / 60.0;
      EXPECT_NEAR(world.bodies().position[0].z(), -0.5 - g * t * t / 2, 1e-5) << "free fall";
    }
    for (int k = 0; k < 120; ++k) {
      world.step();
      EXPECT_LT(world.measure().max_joint_error, 1e-6) << "it never comes further than the rope is long";
    }
    EXPECT_NEAR(world.bodies().position[0].z(), -2, 1e-6) << "and hangs there: ropes do not bounce";
    EXPECT_NEAR(world.bodies().velocity[0].z(), 0, 1e-5);
  }
}

TEST_P(Jointed, AStrutKeepsItsDistance) {
  Scene scene = joint_space(0);
  scene.bodies = {sphere(0.2, Vector3d(-3, 0, 0), Vector3d(2, 0, 0)),
                  sphere(0.2, Vector3d(3, 0, 0), Vector3d(-2, 0, 0))};
  Joint strut = joint_between(JointKind::distance, 0, 1);
  strut.min_length = 1.5;
  scene.joints = {strut};
  World world(scene, options());
  world.step(240);
  const BodyStates s = world.bodies();
  EXPECT_NEAR((s.position[1] - s.position[0]).norm(), 1.5, 1e-9);
  EXPECT_NEAR(s.velocity[0].norm(), 0, 1e-9);
}

/// The extension at `t` of a spring released at 1, relative to the initial extension.
double damped(double frequency, double ratio, double t) {
  const double w = 2 * pi * frequency, decay = std::exp(-ratio * w * t);
  if (ratio == 1) return decay * (1 + w * t);
  const double r = w * std::sqrt(std::abs(1 - ratio * ratio));
  return ratio < 1 ? decay * (std::cos(r * t) + ratio * w / r * std::sin(r * t))
                   : decay * (std::cosh(r * t) + ratio * w / r * std::sinh(r * t));
}

/// The largest difference from the closed form in two seconds, relative to the initial extension.
double spring_error(double frequency, double ratio, int substeps, Precision precision,
                    const RunOptions& options) {
  Scene scene = joint_space(0, precision);
  scene.physics.substeps = substeps;
  scene.bodies = {sphere(0.3, Vector3d(1, 0, 0)), sphere(0.3, Vector3d(2.5, 0, 0))};
  scene.bodies[0].mass = 3;
  scene.bodies[1].mass = 1;
  Joint spring = joint_between(JointKind::spring, 0, 1);
  spring.length = 1;
  spring.frequency = frequency;
  spring.damping_ratio = ratio;
  scene.joints = {spring};
  World world(scene, options);
  double worst = 0;
  for (int k = 1; k <= 120; ++k) {
    world.step();
    const BodyStates s = world.bodies();
    const double stretch = ((s.position[1] - s.position[0]).norm() - 1) / 0.5;
    worst = std::max(worst, std::abs(stretch - damped(frequency, ratio, k / 60.0)));
  }
  return worst;
}

TEST_P(Jointed, SpringsFollowTheClosedForm) {
  for (const double frequency : {0.5, 2.0, 5.0})
    for (const double ratio : {0.0, 0.1, 0.7, 1.0, 3.0}) {
      const double h = 1.0 / 240, angle = 2 * pi * frequency * h;
      const double coarse = spring_error(frequency, ratio, 4, Precision::f64, options());
      // Euler's velocity lags by half a substep. Frequency and decay do not depend on h.
      EXPECT_LT(coarse, 0.6 * angle) << frequency << ' ' << ratio;
      const double fine = spring_error(frequency, ratio, 16, Precision::f64, options());
      EXPECT_NEAR(coarse / fine, 4, 0.4) << "first order: " << frequency << ' ' << ratio;
      EXPECT_NEAR(spring_error(frequency, ratio, 4, Precision::f32, options()), coarse, 2e-4);
    }
}

TEST_P(Jointed, SpringsSwingAsOftenAsTheyShouldWhateverTheSubstep) {
  // A hundred oscillations must have the right count.
  Scene scene = joint_space(0);
  scene.physics.substeps = 1;
  scene.bodies = {sphere(0.3, Vector3d(1.5, 0, 0))};
  Joint spring = joint_to_world(JointKind::spring, 0, Vector3d(0, 0, 0));
  spring.length = 1;
  spring.frequency = 5;  // h w = 0.52
  scene.joints = {spring};
  World world(scene, options());
  world.step(1200);
  const double x = world.bodies().position[0].x();
  EXPECT_NEAR(x, 1.5, 0.5 * 0.52 * 0.52 / 2) << "after 100 periods it is where it began";
  double highest = 0, lowest = 9;
  for (int k = 0; k < 60; ++k) {
    world.step();
    highest = std::max(highest, world.bodies().position[0].x());
    lowest = std::min(lowest, world.bodies().position[0].x());
  }
  EXPECT_NEAR(highest, 1.5, 0.08);
  EXPECT_NEAR(lowest, 0.5, 0.08);
}

TEST_P(Jointed, ALoadedSpringHangsWhereItShould) {
  Scene scene = joint_space(g);
  scene.bodies = {sphere(0.3, Vector3d(0, 0, -1))};
  Joint spring = joint_to_world(JointKind::spring, 0, Vector3d(0, 0, 0));
  spring.length = 1;
  spring.frequency = 2;
  spring.damping_ratio = 1;
  scene.joints = {spring};
  World world(scene, options());
  world.step(240);
  const double w = 2 * pi * 2, sag = g / (w * w);
  EXPECT_NEAR(world.bodies().position[0].z(), -1 - sag, sag * w / 240) << "m g / k, to first order";
  EXPECT_NEAR(world.measure().spring_energy, 0.5 * 4 / 3 * pi * 27 * w * w * sag * sag, 60 * sag);
}

TEST_P(Jointed, TheStiffestSpringIsARod) {
  Scene scene = joint_space(g);
  scene.bodies = {sphere(0.3, Vector3d(1, 0, 0))};
  Joint spring = joint_to_world(JointKind::spring, 0, Vector3d(0, 0, 0));
  spring.frequency = 1e6;
  spring.damping_ratio = 1;
  scene.joints = {spring};
  World world(scene, options());
  const double h = 1.0 / 240;
  for (int k = 0; k < 300; ++k) {
    world.step();
    // The stiffness is that of one radian per substep. The load of a pendulum is at most 3 m g, so the rod
    // stretches by 3 g h^2.
    EXPECT_NEAR(world.bodies().position[0].norm(), 1, 2 * 3 * g * h * h);
  }
}

TEST_P(Jointed, ANetOfStiffSpringsStaysCalm) {
  Scene scene = joint_space(g, Precision::f32);
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 5; ++x) {
      scene.bodies.push_back(sphere(0.1, Vector3d(x, y, 0)));
      scene.bodies.back().mass = 1 + (x * 7 + y * 3) % 5;
    }
  for (int i = 0; i < 25; ++i)
    for (int k = 0; k < i; ++k)
      if ((scene.bodies[static_cast<std::size_t>(i)].position -
           scene.bodies[static_cast<std::size_t>(k)].position)
              .norm() < 1.5) {
        scene.joints.push_back(joint_between(JointKind::spring, i, k));
        scene.joints.back().frequency = 1e4;
        scene.joints.back().damping_ratio = 0.1;
      }
  for (const int corner : {0, 4, 20, 24})
    scene.joints.push_back(
        joint_to_world(JointKind::ball, corner, scene.bodies[static_cast<std::size_t>(corner)].position));
  World world(scene, options());
  const double energy = world.measure().energy();
  for (int k = 0; k < 600; ++k) {
    world.step();
    EXPECT_LT(world.measure().energy(), energy + 0.01 * 75 * g) << "it swings, and gains nothing";
  }
  EXPECT_EQ(world.measure().non_finite, 0);
  EXPECT_LT(world.measure().max_joint_error, 0.02);
}

}  // namespace
}  // namespace collidoscope

// Tests joints against closed forms and conservation laws, on every executor.
// More than 400 lines: every kind of joint has its own closed form.

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "sim_cuda/core/series.h"
#include "sim_cuda/run/published_records.h"
#include "sim_cuda/scene/joint_substeps.h"
#include "sim_cuda/scene/joint_trees.h"
#include "tests/executors.h"
#include "tests/gravity.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

using std::numbers::pi;

class Jointed : public OnEachExecutor {};
ON_EACH_EXECUTOR(Jointed);

/// Restitution 0, solver soft_step, 60 steps per second.
Scene space(double gravity, Precision precision = Precision::f64) {
  Scene scene = empty_space();
  scene.physics.solver = Solver::soft_step;
  scene.physics.precision = precision;
  scene.physics.gravity = Vector3d(0, 0, -gravity);
  scene.physics.time_step = 1.0 / 60;
  scene.materials[0].restitution = 0;
  return scene;
}

Joint to_world(JointKind kind, std::int64_t body, const Vector3d& place) {
  Joint joint;
  joint.kind = kind;
  joint.a = body;
  joint.anchor_b = place;
  return joint;
}

Joint between(JointKind kind, std::int64_t a, std::int64_t b) {
  Joint joint;
  joint.kind = kind;
  joint.a = a;
  joint.b = b;
  return joint;
}

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

// ---- pendulums ----

struct Swing {
  double period, worst_energy, last_energy, worst_error,
      worst_angle;  ///< energies relative to the swing energy
};

/// Ten periods of a sphere of 0.3 m, 1 m from the pivot, released at `amplitude`.
Swing swing(JointKind kind, double amplitude, int substeps, Precision precision, const RunOptions& options) {
  Scene scene = space(g, precision);
  scene.physics.substeps = substeps;
  const Vector3d start(std::sin(amplitude), 0, -std::cos(amplitude));
  scene.bodies = {sphere(0.3, start)};
  scene.bodies[0].mass = 2;
  Joint joint = to_world(kind, 0, Vector3d(0, 0, 0));
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
  Scene scene = space(g);
  scene.bodies = {sphere(0.3, Vector3d(1, 0, 0))};
  scene.joints = {to_world(JointKind::distance, 0, Vector3d(0, 0, 0))};
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

// ---- ropes ----

TEST_P(Jointed, ARopeIsSlackUntilItIsTaut) {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    Scene scene = space(g, precision);
    scene.physics.integrator = Integrator::semi_implicit_euler;
    scene.bodies = {sphere(0.2, Vector3d(0, 0, -0.5))};
    Joint rope = to_world(JointKind::distance, 0, Vector3d(0, 0, 0));
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
  Scene scene = space(0);
  scene.bodies = {sphere(0.2, Vector3d(-3, 0, 0), Vector3d(2, 0, 0)),
                  sphere(0.2, Vector3d(3, 0, 0), Vector3d(-2, 0, 0))};
  Joint strut = between(JointKind::distance, 0, 1);
  strut.min_length = 1.5;
  scene.joints = {strut};
  World world(scene, options());
  world.step(240);
  const BodyStates s = world.bodies();
  EXPECT_NEAR((s.position[1] - s.position[0]).norm(), 1.5, 1e-9);
  EXPECT_NEAR(s.velocity[0].norm(), 0, 1e-9);
}

// ---- springs ----

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
  Scene scene = space(0, precision);
  scene.physics.substeps = substeps;
  scene.bodies = {sphere(0.3, Vector3d(1, 0, 0)), sphere(0.3, Vector3d(2.5, 0, 0))};
  scene.bodies[0].mass = 3;
  scene.bodies[1].mass = 1;
  Joint spring = between(JointKind::spring, 0, 1);
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
  Scene scene = space(0);
  scene.physics.substeps = 1;
  scene.bodies = {sphere(0.3, Vector3d(1.5, 0, 0))};
  Joint spring = to_world(JointKind::spring, 0, Vector3d(0, 0, 0));
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
  Scene scene = space(g);
  scene.bodies = {sphere(0.3, Vector3d(0, 0, -1))};
  Joint spring = to_world(JointKind::spring, 0, Vector3d(0, 0, 0));
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
  Scene scene = space(g);
  scene.bodies = {sphere(0.3, Vector3d(1, 0, 0))};
  Joint spring = to_world(JointKind::spring, 0, Vector3d(0, 0, 0));
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
  Scene scene = space(g, Precision::f32);
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
        scene.joints.push_back(between(JointKind::spring, i, k));
        scene.joints.back().frequency = 1e4;
        scene.joints.back().damping_ratio = 0.1;
      }
  for (const int corner : {0, 4, 20, 24})
    scene.joints.push_back(
        to_world(JointKind::ball, corner, scene.bodies[static_cast<std::size_t>(corner)].position));
  World world(scene, options());
  const double energy = world.measure().energy();
  for (int k = 0; k < 600; ++k) {
    world.step();
    EXPECT_LT(world.measure().energy(), energy + 0.01 * 75 * g) << "it swings, and gains nothing";
  }
  EXPECT_EQ(world.measure().non_finite, 0);
  EXPECT_LT(world.measure().max_joint_error, 0.02);
}

// ---- balls and hinges ----

/// Two non-spherical bodies that tumble, with an anchor beside both centres.
Scene tumbling(JointKind kind) {
  Scene scene = space(0);
  scene.bodies = {sphere(0.5, Vector3d(0, 0, 0), Vector3d(0.2, 0.1, 0.3)),
                  sphere(0.5, Vector3d(1, 0, 0), Vector3d(0.2, 0.1, 0.3))};
  scene.bodies[0].mass = 2;
  scene.bodies[0].inertia = Vector3d(0.1, 0.2, 0.25);
  scene.bodies[1].mass = 1;
  scene.bodies[1].inertia = Vector3d(0.2, 0.1, 0.15);
  scene.bodies[1].orientation = Quaterniond(0.8, 0.6, 0, 0);
  for (Body& body : scene.bodies) body.angular_velocity = Vector3d(1, 3, -2);
  scene.bodies[1].velocity += Vector3d(1, 3, -2).cross(Vector3d(1, 0, 0));  // initially a common rigid motion
  scene.bodies[1].angular_velocity += Vector3d(0, 0, 4);
  const Vector3d anchor(0.5, 0.1, 0);
  scene.bodies[1].velocity -= Vector3d(0, 0, 4).cross(anchor - Vector3d(1, 0, 0));
  Joint joint = between(kind, 0, 1);
  joint.anchor_a = anchor;
  scene.joints = {joint};
  return scene;
}

struct Kept {
  double momentum, energy, error, angle;  ///< the largest change, the last two absolute
};

Kept kept_by(const Scene& scene, int steps, const RunOptions& options) {
  World world(scene, options);
  const StepStats first = world.measure();
  Kept kept{};
  for (int k = 0; k < steps; ++k) {
    world.step();
    const StepStats now = world.measure();
    for (int axis = 0; axis < 3; ++axis) {
      kept.momentum = std::max(kept.momentum, std::abs(now.momentum[axis] - first.momentum[axis]));
      kept.momentum =
          std::max(kept.momentum, std::abs(now.angular_momentum[axis] - first.angular_momentum[axis]));
    }
    kept.energy = std::max(kept.energy, std::abs(now.energy() / first.energy() - 1));
    kept.error = std::max(kept.error, now.max_joint_error);
    kept.angle = std::max(kept.angle, now.max_joint_angle);
  }
  return kept;
}

TEST_P(Jointed, ATumblingPairKeepsItsMomentaAndItsAnchors) {
  for (const JointKind kind : {JointKind::distance, JointKind::ball, JointKind::hinge}) {
    Scene scene = tumbling(kind);
    if (kind == JointKind::distance) {
      scene.joints[0].anchor_b = Vector3d(-0.3, 0.2, 0.1);
      scene.joints[0].max_length = 0.8;
    }
    const Kept kept = kept_by(scene, 300, options());
    EXPECT_LT(kept.momentum, 1e-12) << "to rounding";
    // The joint is solved for the spin at the start of a substep, which gyroscopic torques then change: an
    // error of second order.
    EXPECT_LT(kept.error, 6e-5);
    EXPECT_LT(kept.angle, 1e-3);
    if (kind != JointKind::distance) {  // a taut rope is inelastic
      EXPECT_LT(kept.energy, 1e-3);
    }
    scene.physics.substeps = 16;
    const Kept finer = kept_by(scene, 300, options());
    EXPECT_LT(finer.error, 4e-6);
    EXPECT_LT(finer.angle, 1e-4);
    if (kind != JointKind::distance) {
      EXPECT_LT(finer.energy, 1e-4);
    }
    EXPECT_LT(finer.momentum, 1e-12);
    scene.physics.precision = Precision::f32;
    const Kept rough = kept_by(scene, 300, options());
    EXPECT_LT(rough.momentum, 3e-3) << "of some 10, over 4,800 substeps";
    EXPECT_LT(rough.error, 1e-5);
    scene.physics = tumbling(kind).physics;
    scene.physics.rotation_update = RotationUpdate::first_order;
    EXPECT_LT(kept_by(scene, 300, options()).error, 1e-5) << "first_order rotates about that spin";
  }
}

TEST_P(Jointed, AFreeHingeKeepsTheAngularMomentumAboutItsAxis) {
  // Two wheels on one axle: each keeps its angular momentum about it.
  Scene scene = space(0);
  scene.bodies = {sphere(0.5, Vector3d(0, 0, -0.6)), sphere(0.5, Vector3d(0, 0, 0.6))};
  scene.bodies[0].angular_velocity = Vector3d(0, 0, 5);
  scene.bodies[1].angular_velocity = Vector3d(0, 0, -3);
  scene.joints = {between(JointKind::hinge, 0, 1)};
  scene.joints[0].anchor_a = Vector3d(0, 0, 0.6);
  World world(scene, options());
  world.step(600);
  const BodyStates s = world.bodies();
  EXPECT_NEAR((s.angular_velocity[0] - Vector3d(0, 0, 5)).norm(), 0, 1e-12);
  EXPECT_NEAR((s.angular_velocity[1] - Vector3d(0, 0, -3)).norm(), 0, 1e-12);
  EXPECT_LT(world.measure().max_joint_angle, 1e-12);
}

/// A sphere on a hinge along y through its centre. The other side is the world. The sphere spins at `spin`.
Scene hinged(double spin, const std::optional<std::array<double, 2>>& limits) {
  Scene scene = space(0);
  scene.bodies = {sphere(0.5, Vector3d(1, 2, 3))};
  scene.bodies[0].angular_velocity = Vector3d(0, spin, 0);
  Joint hinge;
  hinge.kind = JointKind::hinge;
  hinge.a = 0;
  hinge.axis = Vector3d(0, 1, 0);
  hinge.limits = limits;
  scene.joints = {hinge};
  return scene;
}

double angle_about_y(const Quaterniond& q) { return 2 * std::atan2(q.y(), q.w()); }

TEST_P(Jointed, AHingeStopsAtItsLimits) {
  // The limits apply to b, here the world, relative to a. Body a rotates the opposite way.
  for (const double spin : {-7.0, -0.9, 0.4, 5.0})
    for (const double limit : {1.0, 45.0, 90.0, 170.0}) {
      World world(hinged(spin, std::array{-limit, limit / 2}), options());
      world.step(4000 / static_cast<int>(std::ceil(std::abs(spin))));
      const double expected = (spin > 0 ? limit : -limit / 2) * pi / 180;
      EXPECT_NEAR(angle_about_y(world.bodies().orientation[0]), expected, 1e-6) << spin << ' ' << limit;
      EXPECT_LT(world.bodies().angular_velocity[0].norm(), 1e-6);
      EXPECT_LT(world.measure().max_joint_angle, 1e-6);
    }
}

TEST_P(Jointed, AHingeTurnsOnlyAboutItsAxis) {
  Scene scene = hinged(2, {});
  scene.bodies[0].angular_velocity = Vector3d(3, 2, -1);
  World world(scene, options());
  for (int k = 0; k < 120; ++k) {
    world.step();
    const Vector3d axis = world.bodies().orientation[0] * Vector3d(0, 1, 0);
    EXPECT_NEAR((axis - Vector3d(0, 1, 0)).norm(), 0, 1e-9);
    EXPECT_NEAR(world.bodies().angular_velocity[0].y(), 2, 1e-9) << "about it, nothing holds";
    EXPECT_NEAR((world.bodies().position[0] - Vector3d(1, 2, 3)).norm(), 0, 1e-12);
  }
}

// ---- chains and loops ----

/// Fifty links of 1 m, the last with 1,000 times the mass, released horizontally or hanging down.
Scene chain(JointKind kind, bool to_the_side, double ratio) {
  Scene scene = space(g, Precision::f32);
  const Vector3d link = to_the_side ? Vector3d(1, 0, 0) : Vector3d(0, 0, -1);
  for (int i = 0; i < 50; ++i) {
    scene.bodies.push_back(sphere(0.4, (i + 1) * link));
    scene.bodies.back().mass = i == 49 ? ratio : 1;
    Joint joint = i == 0 ? to_world(kind, 0, Vector3d(0, 0, 0)) : between(kind, i, i - 1);
    if (kind == JointKind::ball) {
      joint.anchor_a = -link / 2;
      joint.anchor_b = link / 2;
    }
    scene.joints.push_back(joint);
  }
  return scene;
}

/// Adds slack ropes from each body to the world: more loops than are solved directly, so that all joints are
/// iterated.
Scene looped(Scene scene) {
  const int bodies = static_cast<int>(scene.bodies.size());
  for (int k = 0; k < bodies * (1 + JointTrees::max_closing_rows / bodies); ++k) {
    Joint rope = to_world(JointKind::distance, k % bodies, Vector3d(0, 0, 0));
    rope.max_length = 1e4;
    scene.joints.push_back(rope);
  }
  return scene;
}

struct Stretch {
  double chain = 0, joint = 0;  ///< largest: of the chain, relative; of a joint, m
};

Stretch stretch_of(const Scene& scene, const RunOptions& options) {
  World world(scene, options);
  Stretch largest;
  for (int k = 0; k < 240; ++k) {
    world.step();
    const BodyStates s = world.bodies();
    double length = s.position[0].norm();
    for (std::size_t i = 1; i < 50; ++i) length += (s.position[i] - s.position[i - 1]).norm();
    largest.chain = std::max(largest.chain, length / 50 - 1);
    largest.joint = std::max(largest.joint, world.measure().max_joint_error);
  }
  return largest;
}

TEST_P(Jointed, AChainOf50BelowALoadKeepsItsLength) {
  for (const JointKind kind : {JointKind::distance, JointKind::ball})
    for (const bool to_the_side : {false, true})
      for (const double ratio : {1e3, to_the_side ? 1e4 : 1e6}) {
        const Scene scene = chain(kind, to_the_side, ratio);
        EXPECT_EQ(substeps_of(scene, initial_bodies(scene)), 4);
        const Stretch stretch = stretch_of(scene, options());
        EXPECT_LT(stretch.chain, 1e-6) << ratio << ' ' << to_the_side;
        EXPECT_LT(stretch.joint, 2e-5) << "rounding of float at 50 m";
      }
}

TEST_P(Jointed, AnIteratedChainOf50StretchesUnder2PercentBelow1000TimesItsMass) {
  for (const bool to_the_side : {false, true}) {
    const Scene scene = looped(chain(JointKind::distance, to_the_side, 1000));
    EXPECT_EQ(substeps_of(scene, initial_bodies(scene)), 21);
    const Stretch stretch = stretch_of(scene, options());
    EXPECT_LT(stretch.chain, 0.02) << to_the_side;
    EXPECT_LT(stretch.joint, 0.04) << "no link of 1 m, either";
  }
}

TEST_P(Jointed, AHangingLoadRests) {
  Scene scene = chain(JointKind::distance, false, 200);
  scene.bodies.erase(scene.bodies.begin(), scene.bodies.begin() + 45);
  scene.joints.resize(5);
  for (int i = 0; i < 5; ++i) scene.bodies[static_cast<std::size_t>(i)].position.z() = -(i + 1);
  scene.physics.substeps = 16;
  World tree(scene, options());
  tree.step(3000);
  EXPECT_LT(tree.measure().max_joint_error, 2e-6) << "joints of a tree do not yield";
  World iterated(looped(scene), options());
  iterated.step(3000);
  EXPECT_LT(iterated.measure().max_joint_error, 2e-4);
  EXPECT_LT(iterated.measure().max_speed, 1e-3);
}

TEST(JointSubsteps, AreAsManyAsTheLoadCallsFor) {
  const auto of = [](const Scene& scene) { return substeps_of(scene, initial_bodies(scene)); };
  EXPECT_EQ(of(chain(JointKind::distance, false, 1000)), 4) << "joints of a tree do not yield";
  Scene scene = looped(chain(JointKind::distance, false, 1000));
  // Three joints at a body: the stretch is 3 F h^2 / (4 m) with m = 1/2 kg, at most 1 % of 1 m.
  const double load = (49 + 1000) * g, h = std::sqrt(0.01 * 4 * 0.5 / (3 * load));
  EXPECT_EQ(of(scene), static_cast<int>(std::ceil(1 / (60 * h))));
  scene.physics.time_step = scene.physics.time_step / 2;
  EXPECT_EQ(of(scene), static_cast<int>(std::ceil(1 / (120 * h))));
  scene.physics.substeps = 3;
  EXPECT_EQ(of(scene), 3);
  EXPECT_EQ(substeps_missed(scene, initial_bodies(scene)), 0) << "the number is set";
  scene.physics.substeps.reset();
  scene.bodies[49].mass = 1e12;
  EXPECT_EQ(of(scene), 64) << "and no more";
  EXPECT_NEAR(substeps_missed(scene, initial_bodies(scene)),
              std::ceil(1 / (120 * h) * std::sqrt(1e12 / 1049)), 1e-3 / (120 * h) * std::sqrt(1e12 / 1049));
  scene.physics.gravity.setZero();
  EXPECT_EQ(of(scene), 4) << "nothing hangs";
  EXPECT_EQ(substeps_missed(scene, initial_bodies(scene)), 0);
  scene = chain(JointKind::distance, false, 1);
  scene.joints.clear();
  scene.physics.solver = Solver::impulse;
  EXPECT_EQ(of(scene), 1);
}

TEST_P(Jointed, LoopsAndRedundantJointsStayFinite) {
  Scene scene = space(g, Precision::f32);
  for (int i = 0; i < 4; ++i)
    scene.bodies.push_back(sphere(0.3, Vector3d(i % 2 == 0 ? 0 : 1, 0, i < 2 ? 0 : -1)));
  // A square with both diagonals, one of them too long. All joints exist twice, and hinges are added.
  for (int twice = 0; twice < 2; ++twice)
    for (const auto& [a, b] : {std::pair(0, 1), {1, 3}, {3, 2}, {2, 0}, {0, 3}, {1, 2}}) {
      scene.joints.push_back(between(JointKind::distance, a, b));
      if (a == 0 && b == 3) scene.joints.back().length = 1.6;
    }
  scene.joints.push_back(between(JointKind::hinge, 0, 1));
  scene.joints.push_back(between(JointKind::ball, 0, 1));
  scene.joints.push_back(to_world(JointKind::ball, 0, Vector3d(0, 0, 0)));
  scene.joints.push_back(to_world(JointKind::hinge, 0, Vector3d(0, 0, 0)));
  World world(scene, options());
  world.step(1800);
  const StepStats stats = world.measure();
  EXPECT_EQ(stats.non_finite, 0);
  EXPECT_EQ(stats.joints, 16);
  EXPECT_LT(stats.max_joint_error, 0.15) << "all share what the diagonal is off";
  EXPECT_LT(stats.max_speed, 0.01) << "and hang still";
}

/// Joints that are metres apart, at bodies with a small moment of inertia. Warm starting with impulses for
/// the lever arms of the previous substep added energy in each substep.
TEST_P(Jointed, ContradictionsStayBoundedHoweverLightlyBodiesTurn) {
  for (const double inertia : {1.0, 100.0, 650.0}) {
    Scene scene = space(g, Precision::f64);
    scene.physics.substeps = 30;
    scene.physics.iterations = 2;
    scene.bodies = {sphere(2.6, Vector3d(0, 0, -4)), sphere(0.12, Vector3d(0, 0, 8))};
    scene.bodies[0].mass = 650'000;
    scene.bodies[0].inertia = inertia * Vector3d(1, 1.07, 1.06);
    scene.bodies[1].mass = 1.2;
    scene.joints = {to_world(JointKind::ball, 0, Vector3d(-1.6, -1.8, -3.2)),
                    to_world(JointKind::ball, 1, Vector3d(0.9, 1.7, 8.8)), between(JointKind::hinge, 1, 0)};
    scene.joints[0].anchor_a = Vector3d(0, -1, -0.3);
    scene.joints[1].anchor_a = Vector3d(-0.66, 0, 0);
    World world(scene, options());
    world.step(240);
    const StepStats stats = world.measure();
    EXPECT_EQ(stats.non_finite, 0) << inertia;
    EXPECT_LT(stats.max_speed, 1e5) << inertia;
  }
}

TEST_P(Jointed, BodiesHeldTogetherMayTouchOnlyIfTheySaySo) {
  for (const bool collide : {false, true}) {
    Scene scene = space(0);
    scene.bodies = {sphere(0.5, Vector3d(0, 0, 0)), sphere(0.5, Vector3d(0.6, 0, 0)),
                    sphere(0.5, Vector3d(0.3, 0.4, 0))};
    scene.joints = {between(JointKind::distance, 1, 0)};
    scene.joints[0].collide = collide;
    World world(scene, options());
    EXPECT_EQ(world.measure().touching, collide ? 3 : 2) << "the third touches both";
    EXPECT_EQ(world.measure().pairs, 3);
  }
}

TEST_P(Jointed, BodiesThatNoForceMovesHoldTheOthers) {
  // A kinematic body pulls a pendulum along at constant speed. The motion in its frame equals that of the
  // fixed one.
  Scene scene = space(g);
  scene.bodies = {sphere(0.1, Vector3d(0, 0, 0), Vector3d(3, 0, 0)),
                  sphere(0.3, Vector3d(1, 0, 0), Vector3d(3, 0, 0)), sphere(0.1, Vector3d(0, 5, 0)),
                  sphere(0.3, Vector3d(1, 5, 0))};
  scene.bodies[0].motion = Motion::kinematic;
  scene.bodies[2].motion = Motion::fixed;
  scene.joints = {
      between(JointKind::distance, 0, 1), between(JointKind::distance, 3, 2),
      between(JointKind::ball, 0, 2)};  // a joint between two bodies without dynamics has no effect
  World world(scene, options());
  world.step(120);
  const BodyStates s = world.bodies();
  EXPECT_NEAR((s.position[0] - Vector3d(6, 0, 0)).norm(), 0, 1e-9);
  EXPECT_NEAR((s.position[2] - Vector3d(0, 5, 0)).norm(), 0, 0);
  EXPECT_NEAR(((s.position[1] - s.position[0]) - (s.position[3] - s.position[2])).norm(), 0, 1e-6);
  EXPECT_NEAR((s.position[3] - s.position[2]).norm(), 1, 1e-6);
}

TEST_P(Jointed, AreDrawnWhereTheyAre) {
  Scene scene = space(g);
  scene.bodies = {sphere(0.5, Vector3d(0, 0, 0)), sphere(0.25, Vector3d(3, 0, 0)),
                  sphere(1, Vector3d(0, 9, 0))};
  scene.bodies[1].orientation = Quaterniond(std::sqrt(0.5), 0, 0, std::sqrt(0.5));  // x to y
  Joint rope = between(JointKind::distance, 0, 1);
  rope.max_length = 5;
  rope.anchor_b = Vector3d(1, 0, 0);
  Joint hinge = to_world(JointKind::hinge, 2, Vector3d(0, 8, 0));
  hinge.anchor_a = Vector3d(0, -1, 0);
  hinge.axis = Vector3d(1, 0, 0);
  scene.joints = {rope, between(JointKind::spring, 2, 1), hinge};
  World world(scene, options());
  ASSERT_EQ(world.publisher().counts(0, -1).joints, 3);
  PublishedRecords records;
  world.publisher().copy(FrameLayers{}, records);
  const auto drawn = records.copy<JointInstance>();
  ASSERT_EQ(drawn.size(), 3u);
  // The spring is solved by iteration. Joints of trees follow.
  const auto at = [](const float(&v)[3]) { return Vector3d(v[0], v[1], v[2]); };
  EXPECT_EQ(drawn[1].look, static_cast<float>(JointLook::rope));
  EXPECT_NEAR((at(drawn[1].from) - Vector3d(0, 0, 0)).norm(), 0, 1e-6);
  EXPECT_NEAR((at(drawn[1].to) - Vector3d(3, 1, 0)).norm(), 0, 1e-6);
  EXPECT_EQ(drawn[1].size, 0.25f);
  const double length = std::sqrt(10.0), sag = std::sqrt((5 - length) * (5.0 / 4 + length / 8));
  EXPECT_NEAR((at(drawn[1].aside) - Vector3d(0, 0, -sag)).norm(), 0, 1e-5);
  EXPECT_EQ(drawn[2].look, static_cast<float>(JointLook::corner));
  EXPECT_NEAR((at(drawn[2].from) - Vector3d(0, 9, 0)).norm(), 0, 1e-6);
  EXPECT_NEAR((at(drawn[2].at) - Vector3d(0, 8, 0)).norm(), 0, 1e-6);
  EXPECT_NEAR((at(drawn[2].to) - Vector3d(0, 8, 0)).norm(), 0, 1e-6);
  EXPECT_NEAR((at(drawn[2].aside) - Vector3d(1, 0, 0)).norm(), 0, 1e-6);
  EXPECT_EQ(drawn[0].look, static_cast<float>(JointLook::spring));
}

// ---- determinism ----

Scene everything(Precision precision) {
  Scene scene = box_collider(300);
  scene.physics.solver = Solver::soft_step;
  scene.physics.precision = precision;
  scene.materials[0].friction = 0.3;
  const JointKind kinds[] = {JointKind::distance, JointKind::spring, JointKind::ball, JointKind::hinge};
  for (int k = 0; k < 200; ++k) {
    Joint joint = between(kinds[k % 4], k, (k * 7 + 1) % 300);
    if (joint.a == *joint.b) joint.b = 299;
    joint.anchor_a = Vector3d(0.1 * (k % 3), 0.2, 0);
    if (k % 4 == 3) joint.limits = {-10, 20};
    if (k % 8 == 0) joint.max_length = 40;
    if (k % 11 == 0) joint.b.reset();
    if (!joint.b) joint.anchor_b = Vector3d(50, 50, 50);
    scene.joints.push_back(joint);
  }
  return scene;
}

TEST_P(Jointed, OneAnswerInEveryOrderAndShape) {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    const Scene scene = everything(precision);
    const auto hash = [&](const RunOptions& o) {
      World world(scene, o);
      world.step(12);
      EXPECT_EQ(world.measure().non_finite, 0);
      return world.state_hash();
    };
    const std::uint64_t expected = hash(options());
    for (const LaunchShape shape : {LaunchShape{1, 1}, {2, 4}, {16, 16}, {264, 128}})
      for (const LaneOrder order : {LaneOrder::contiguous, LaneOrder::strided, LaneOrder::shuffled}) {
        if (GetParam() == ExecutorKind::cuda && order != LaneOrder::contiguous) continue;
        RunOptions o = options();
        o.shape = shape;
        o.lane_order = order;
        EXPECT_EQ(hash(o), expected) << shape.blocks << ' ' << static_cast<int>(order);
      }
    RunOptions tight = options();
    tight.initial_pair_capacity = 1;
    EXPECT_EQ(hash(tight), expected) << "an overflow leaves joints as they are";
    RunOptions cpu = options();
    cpu.executor = ExecutorKind::cpu;
    EXPECT_EQ(hash(cpu), expected);
  }
}

TEST_P(Jointed, AnotherWorldGoesOnBitForBit) {
  const Scene scene = everything(Precision::f32);
  World whole(scene, options()), first(scene, options()), second(scene, options());
  whole.step(20);
  first.step(11);
  second.restore(first);
  second.step(9);
  EXPECT_EQ(second.state_hash(), whole.state_hash());

  // After a removal of the last bodies and their joints, the remaining joints keep their impulses.
  Scene fewer = scene;
  fewer.generators[0].count = 150;
  std::erase_if(fewer.joints,
                [](const Joint& joint) { return joint.a >= 150 || joint.b.value_or(0) >= 150; });
  ASSERT_GT(fewer.joints.size(), 50u);
  World rest(fewer, options());
  rest.restore(first);
  rest.step(5);
  EXPECT_EQ(rest.measure().non_finite, 0);
}

TEST_P(Jointed, WithoutJointsNothingIsPaid) {
  Scene scene = box_collider(300);
  scene.physics.solver = Solver::soft_step;
  World never(scene, options());
  Scene listed = scene;
  listed.joints = {between(JointKind::distance, 0, 1)};
  listed.joints[0].length = 1;
  listed.physics.effects = Effects{.gravity = true};
  World off(listed, options());
  never.step(4);
  off.step(4);
  EXPECT_EQ(off.info().allocated_bytes, never.info().allocated_bytes);
  EXPECT_EQ(off.state_hash(), never.state_hash());
  const auto launches = [](World& world) {
    int sum = 0;
    for (const StageTime& stage : world.times().stages) {
      EXPECT_NE(stage.name, "joints");
      sum += stage.launches;
    }
    return sum;
  };
  EXPECT_EQ(launches(off), launches(never));
  EXPECT_EQ(off.measure().joints, 0);
  listed.physics.effects.reset();
  World on(listed, options());
  on.step(4);
  EXPECT_NE(on.state_hash(), never.state_hash());
  EXPECT_GT(on.info().allocated_bytes, never.info().allocated_bytes);
}

}  // namespace
}  // namespace collidoscope

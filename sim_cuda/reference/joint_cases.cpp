// Joint cases. A rod is solved by the energy-momentum method (solver/joint_tree_solver.h). Along the circle,
// a step turns by 2 b, and its mean velocity points along the tangent at theta + b:
//
//   2 sin b / h = w cos b - r sin b + h a(theta + b) / 2,  w' = 2 sin(2 b) / h - w cos(2 b) + r sin(2 b)
//
// with a = -g/l sin theta. The speed r along the rod is the same at the end.
// Angles and periods are of second order.

#include <cmath>
#include <numbers>

#include "sim_cuda/reference/analytic_cases.h"
#include "sim_cuda/reference/oscillations.h"

namespace collidoscope {
namespace {

/// A rod from the origin to a body released at rest.
struct Rod {
  double w, amplitude;  ///< rad/s, of small oscillations; rad

  explicit Rod(const Scene& scene) {
    const Vector3d first = scene.bodies[0].position;
    w = std::sqrt(-scene.physics.gravity.z() / first.norm());
    amplitude = angle(first);
  }
  static double angle(const Vector3d& x) { return std::atan2(x.x(), -x.z()); }

  static SmoothState state(double at, double rate) {
    SmoothState y(2);
    y << at, rate;
    return y;
  }
  double acceleration(double at) const { return -w * w * std::sin(at); }
  SmoothProblem problem() const {
    return {[rod = *this](const SmoothState& y) { return state(y[1], rod.acceleration(y[0])); },
            [rod = *this](double t) {
              const Oscillation s = pendulum(rod.w, rod.amplitude, t);
              return state(s.at, s.rate);
            },
            w};
  }
  OneStep energy_momentum() const {
    return [rod = *this](const SmoothState& y, double h) {
      double half = h * y[1] / 2, along = 0;
      for (int k = 0; k < 50; ++k) {
        half = std::asin(
            h / 2 * (y[1] * std::cos(half) - along * std::sin(half) + h / 2 * rod.acceleration(y[0] + half)));
        along =
            (4 / h * std::sin(half) * std::sin(half) - y[1] * std::sin(2 * half)) / (1 + std::cos(2 * half));
      }
      return state(y[0] + 2 * half,
                   2 / h * std::sin(2 * half) - y[1] * std::cos(2 * half) + along * std::sin(2 * half));
    };
  }
};

AnalyticCase swing(const char* name, const char* rationale, double horizon) {
  AnalyticCase one;
  one.name = name;
  one.scene = analytic_scene(name);
  one.compared = "angle, rad";
  one.rationale = rationale;
  one.horizon = horizon;
  const Rod rod(one.scene);
  one.scale = std::abs(rod.amplitude) * rod.w * horizon;
  const ComparedPart angle = [](const SmoothState& y) { return SmoothState(y.head(1)); };
  one.methods = by_any_integrator(smooth_theory(rod.problem(), rod.energy_momentum(), 2, horizon, angle));
  one.error = [=, end = pendulum(rod.w, rod.amplitude, horizon).at](World& world, int steps) {
    world.step(steps);
    return std::abs(std::remainder(Rod::angle(world.bodies().position[0]) - end, 2 * std::numbers::pi));
  };
  return one;
}

/// After n periods the pendulum is at rest again, and the error is a time: the error in speed divided by the
/// acceleration.
AnalyticCase period() {
  AnalyticCase one;
  one.name = "pendulum_period";
  one.scene = analytic_scene("pendulum_large");
  one.compared = "period, s";
  one.rationale = "error of the energy-momentum method";
  one.horizon = 12;
  const Rod rod(one.scene);
  const double exact = pendulum_period(rod.w, rod.amplitude), start = rod.acceleration(rod.amplitude);
  const int periods = static_cast<int>(one.horizon / exact);
  one.scale = one.horizon;
  const double late =
      -leading_error(rod.problem(), rod.energy_momentum(), 2, periods * exact)[1] / start / periods;
  one.methods = by_any_integrator(leading_theory(2, std::abs(late)));
  one.error = [=](World& world, int steps) {
    double before = rod.amplitude, first = 0, last = 0;
    int seen = 0;  // downward passes through the lowest point
    for (int k = 1; k <= steps && seen <= periods; ++k) {
      world.step();
      const double now = Rod::angle(world.bodies().position[0]);
      if (before > 0 && now <= 0 && before - now < std::numbers::pi) {
        last = (k - now / (now - before)) * world.scene().physics.time_step;
        if (seen++ == 0) first = last;
      }
      before = now;
    }
    return seen > periods ? std::abs((last - first) / periods - exact) : exact;
  };
  return one;
}

/// The joint's impulse makes the stretch follow the closed form's recurrence for every h
/// (solver/joint_constraint.h). Only the first step is off, by A w^2 h^2 / 2, because the kick precedes the
/// drift.
/// This equals an initial speed error of A w^2 h/2, which oscillates and decays with the solution.
AnalyticCase spring_joint() {
  AnalyticCase one;
  one.name = "spring_joint";
  one.scene = analytic_scene("spring_joint");
  one.compared = "extension, m";
  one.rationale = "frequency and decay are exact; the first velocity update is half a step early";
  one.horizon = 1.2;
  one.scale = 2;
  const Joint joint = one.scene.joints[0];
  const double w = 2 * std::numbers::pi * joint.frequency, z = joint.damping_ratio,
               r = w * std::sqrt(1 - z * z);
  const double first = one.scene.bodies[0].position.x() - *joint.length, t = one.horizon;
  one.methods = by_any_integrator(
      leading_theory(1, first * w * w / (2 * r) * std::exp(-z * w * t) * std::abs(std::sin(r * t))));
  one.error = [=](World& world, int steps) {
    world.step(steps);
    const double stretch = world.bodies().position[0].norm() - *joint.length;
    return std::abs(stretch - first * damped_oscillation(w, z, t).at);
  };
  return one;
}

}  // namespace

std::vector<AnalyticCase> joint_cases() {
  return {swing("pendulum_small", "error of the energy-momentum method", 1.5),
          swing("pendulum_large", "the same, for the elliptic function", 2), period(), spring_joint()};
}

}  // namespace collidoscope

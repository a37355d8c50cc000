// Cases with lasting or repeated contact: rebounds, friction, a stack. Paths and times are of first order in
// h, like those of Moreau's scheme, except for the penetration of soft contacts. The error constants follow
// from the solver and are derived at each case.

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "sim_cuda/reference/analytic_cases.h"
#include "sim_cuda/reference/impacts.h"
#include "sim_cuda/solver/impact.h"
#include "sim_cuda/solver/soft_contact.h"

namespace collidoscope {
namespace {

double gravity(const Scene& scene) { return -scene.physics.gravity.z(); }

Rebounds rebounds(const Scene& scene) {
  const Body& ball = scene.bodies[0];
  return {gravity(scene), ball.position.z() - ball.radius, scene.materials[0].restitution};
}

/// Time in s by which an impact at p m/s is early at most, at least by h less. It is resolved at the start of
/// the first step that is as near to the surface as Euler's method moves the ball in about that step
/// (solver/impact.h): p t - g t^2/2 = (p - g t + g h) R for the reach R in s.
double earliest(double h, double g, double p) {
  const double reach =
      ImpactLaw<double>{.restitution = {}, .gravity = Vector3d::Zero(), .field = nullptr, .h = h, .slow = 0}
          .reach_time();
  const double b = p + g * reach, squared = b * b - 2 * g * reach * (p + g * h);
  return squared > 0 ? (b - std::sqrt(squared)) / g : p / g;
}

/// Errors after the n-th impact, if each is resolved `later` s after earliest(). It moves the ball to the
/// surface, so this is the time that the ball skips. The energy is exact if flight is.
/// Positions of semi-implicit Euler are on a parabola whose start is slower by b = g h/2, and velocities are
/// faster by b than on it. An impact on the parabola at p therefore bounces like one at p - b (from v^2 + 2 g
/// s with Euler's v). A flight whose parabola starts slower by d_n is followed by d_(n+1) = e (d_n + b) + b.
/// It is shorter by 2 d_n / g. The drop is shorter by h/2, at the same speed of impact.
struct ReboundErrors {
  double b, slow = 0, skip;  ///< m/s; m/s, d_n; s, sum of the skipped times

  ReboundErrors(const Rebounds& ball, int n, double h, double later, bool euler)
      : b(euler ? ball.gravity * h / 2 : 0), skip(b / ball.gravity) {
    for (int k = 1; k <= n; ++k) {
      if (k > 1) skip += 2 * slow / ball.gravity;
      skip += earliest(h, ball.gravity, ball.impact_speed(k) - slow - b) - later;
      slow = ball.e * (slow + b) + b;
    }
  }
};

/// Height in m of a ball after `steps` steps of h s, from the closed form of each flight. An impact comes at
/// the first step that starts lower than 17/16 h times the speed at the end of Euler's step, and starts a
/// flight at the surface. The flight of semi-implicit Euler is lower by g h t/2 after t s.
double height_in_steps(const Rebounds& ball, int steps, double h, bool euler) {
  const double g = ball.gravity;
  double start = ball.fall, speed = 0;  // of the flight; speed upwards
  for (int k = 0, flown = 0;; ++k, ++flown) {
    const double t = flown * h, approach = g * t - speed;
    const double height = start + (speed - g * (euler ? t + h : t) / 2) * t;
    if (k == steps) return height;
    if (!(approach > 0 && height < 17.0 / 16 * h * (approach + g * h))) continue;
    start = 0;
    speed = ball.e * std::sqrt(approach * approach + 2 * g * height);
    flown = 0;
  }
}

std::vector<AnalyticMethod> all_integrators(const std::function<Theory(bool euler)>& theory) {
  return {{Integrator::semi_implicit_euler, theory(true)},
          {Integrator::velocity_verlet, theory(false)},
          {Integrator::rk4, theory(false)},
          {.theory = theory(false), .solver = Solver::jacobi_split}};
}

void add_bouncing(std::vector<AnalyticCase>& cases) {
  AnalyticCase one;
  one.name = "bouncing";
  one.scene = analytic_scene("bouncing");
  one.compared = "height after three bounces, m";
  one.rationale = "each bounce is about h/16 to 17/16 h early; Euler: also a speed error of g h per flight";
  one.horizon = 2;
  one.scale = 5;
  const Rebounds ball = rebounds(one.scene);
  const double t = one.horizon, r = one.scene.bodies[0].radius, g = ball.gravity;
  const int n = ball.impacts(t);
  // Height in the flight after the n-th impact, which began too early and too slow, but at most at its top.
  const auto height = [=](double h, double later, bool euler) {
    const ReboundErrors off(ball, n, h, later, euler);
    const double rise = ball.speed(n) - off.slow, flown = std::min(t - ball.time(n) + off.skip, rise / g);
    return (rise - g * flown / 2) * flown;
  };
  one.methods = all_integrators([=](bool euler) {
    return Theory{Claim::bound, 1, [=](double h) {
                    return std::max(std::abs(height(h, h, euler) - ball.height(t)),
                                    std::abs(height(h, 0, euler) - ball.height(t)));
                  }};
  });
  one.error = [=](World& world, int steps) {
    world.step(steps);
    return std::abs(world.bodies().position[0].z() - r - ball.height(t));
  };
  cases.push_back(one);

  one.name = "bouncing_bias";
  one.compared = "height minus that of bounces at the starts of steps, m";
  one.rationale = "the error is exactly that of the times of the bounces, and Euler's bias";
  one.methods = all_integrators([](bool) { return Theory{}; });
  one.error = [=](World& world, int steps) {
    world.step(steps);
    const bool euler = world.scene().physics.integrator == Integrator::semi_implicit_euler;
    return std::abs(world.bodies().position[0].z() - r - height_in_steps(ball, steps, t / steps, euler));
  };
  cases.push_back(one);

  one.name = "bouncing_energy";
  one.compared = "energy per mass after three bounces, m^2/s^2";
  one.rationale =
      "a rebound is on the parabola of an impact at the surface: its energy is exact if flight is";
  one.scale = g * ball.fall;
  one.methods = {{Integrator::velocity_verlet, {}}, {Integrator::rk4, {}}};
  one.error = [=](World& world, int steps) {
    world.step(steps);
    const BodyStates s = world.bodies();
    const double expected = ball.speed(n) * ball.speed(n) / 2;
    return std::abs(s.velocity[0].squaredNorm() / 2 + g * (s.position[0].z() - r) - expected);
  };
  cases.push_back(one);
}

/// Errors are those of ReboundErrors, down to the first impact that may approach slower than 2 g h at the
/// height at which it is resolved, or rebounds slower than g h. Of the remaining time 2 p e / (g (1 - e)),
/// any part may be missing. The last contact takes two steps.
void add_zeno(std::vector<AnalyticCase>& cases) {
  AnalyticCase one;
  one.name = "zeno";
  one.scene = analytic_scene("zeno");
  one.compared = "time of rest, s";
  one.rationale = "each bounce skips time, as in bouncing; no bounce below 2 g h";
  one.horizon = 2;
  one.scale = 2;
  const Rebounds ball = rebounds(one.scene);
  const double r = one.scene.bodies[0].radius;
  one.methods = all_integrators([=](bool euler) {
    return Theory{Claim::bound, 1, [=](double h) {
                    const double g = ball.gravity, e = ball.e;
                    int n = 0;
                    ReboundErrors off(ball, n, h, 0, euler);
                    for (;; off = ReboundErrors(ball, ++n, h, 0, euler)) {
                      const double p = ball.impact_speed(n + 1) - off.slow - off.b;
                      if (!(p > std::max(g * (2 * h + earliest(h, g, p)), g * h / e))) break;
                    }
                    return off.skip + 2 * off.slow / g + 2 * ball.impact_speed(n + 1) * e / (g * (1 - e)) +
                           3 * h;
                  }};
  });
  one.error = [=](World& world, int steps) {
    int moving = 0;
    for (int k = 1; k <= steps; ++k) {
      world.step();
      const BodyStates s = world.bodies();
      if (s.velocity[0].norm() > 1e-5 || s.position[0].z() - r > 1e-5) moving = k;
    }
    return std::abs((moving + 1) * world.scene().physics.time_step - ball.zeno_time());
  };
  cases.push_back(one);
}

/// While the sphere slides, Euler's position is short by mu g h t/2. After that its speed is exact.
void add_slide_to_roll(std::vector<AnalyticCase>& cases, const char* name, double horizon) {
  AnalyticCase one;
  one.name = name;
  one.scene = analytic_scene(name);
  one.compared = "position, m";
  one.rationale = "error mu g h t/2 until the ball rolls at t = 2 (v - r w) / (7 mu g): (v - r w) h/7";
  one.horizon = horizon;
  one.scale = 7;
  const Body ball = one.scene.bodies[0];
  const SlideToRoll slide{ball.velocity.x(), one.scene.materials[0].friction * gravity(one.scene),
                          ball.radius * ball.angular_velocity.y()};
  one.methods = by_any_integrator(leading_theory(1, slide.deceleration * slide.rolling_at() / 2));
  one.error = [=, t = one.horizon](World& world, int steps) {
    world.step(steps);
    return (world.bodies().position[0] - ball.position - Vector3d(slide.distance(t), 0, 0)).norm();
  };
  cases.push_back(one);
}

void add_incline(std::vector<AnalyticCase>& cases, const char* name) {
  AnalyticCase one;
  one.name = name;
  one.scene = analytic_scene(name);
  one.compared = "position, m";
  one.rationale = "uniform acceleration: error a h t/2";
  one.horizon = 1;
  one.scale = 5;
  const Vector3d start = one.scene.bodies[0].position, normal = one.scene.obstacles[0].normal,
                 down(normal.z(), 0, -normal.x());
  const Body& ball = one.scene.bodies[0];
  const double k = ball.inertia ? (*ball.inertia)[0] / (*ball.mass * ball.radius * ball.radius) : 0.4;
  const double a = down_slope(gravity(one.scene), normal.x(), normal.z(), one.scene.materials[0].friction, k);
  const double t = one.horizon;
  one.methods = by_any_integrator(leading_theory(1, a * t / 2));
  one.error = [=](World& world, int steps) {
    world.step(steps);
    return (world.bodies().position[0] - start - a * t * t / 2 * down).norm();
  };
  cases.push_back(one);
}

/// At rest, the spring of a soft contact carries the load: load = mass omega^2 depth. The effective mass of
/// two equal spheres is m/2, and omega = 2 pi/4 per substep. Below k spheres: depth = k m g / (m/2 omega^2).
/// The stack is at rest, except for rounding, after some 1,500 steps of any h.
void add_stack(std::vector<AnalyticCase>& cases) {
  AnalyticCase one;
  one.name = "stack_forces";
  one.scene = analytic_scene("stack");
  one.compared = "largest error of a force, relative to the weight above";
  one.rationale = "at rest the impulses equal the load for every step size";
  one.horizon = 30;
  one.scale = 1;
  const auto n = static_cast<int>(one.scene.bodies.size());
  const double g = gravity(one.scene);
  one.methods = by_any_integrator({});
  one.error = [=](World& world, int steps) {
    world.records().record_impulses(true);
    world.step(steps);
    const double weight = world.initial().mass[0] * g * world.scene().physics.time_step;
    double worst = 0;
    int contacts = 0;
    for (const ContactImpulse& contact : world.records().impulses()) {
      const double above = (n - 1 - static_cast<int>(contact.a)) * weight;
      worst = std::max(worst, std::abs(contact.impulse / above - 1));
      ++contacts;
    }
    return contacts == n - 1 ? worst : 1.0;
  };
  cases.push_back(one);

  one.name = "stack_sinking";
  one.compared = "height of the top, m";
  one.scale = 5;
  one.rationale = "contacts compress by load / (mass omega^2), omega h = pi/2: 4 n (n - 1) g h^2 / pi^2";
  const double turn = 2 * std::numbers::pi * Softness<double>::cycles_per_substep;
  one.methods = by_any_integrator(leading_theory(2, g * n * (n - 1) / (turn * turn)),
                                  {Solver::soft_step, Solver::jacobi_split});
  const double height = one.scene.bodies.back().position.z();
  one.error = [=](World& world, int steps) {
    world.step(steps);
    return std::abs(world.bodies().position.back().z() - height);
  };
  cases.push_back(one);
}

}  // namespace

std::vector<AnalyticCase> contact_cases() {
  std::vector<AnalyticCase> cases;
  add_bouncing(cases);
  add_zeno(cases);
  add_slide_to_roll(cases, "slide_to_roll", 1);
  add_slide_to_roll(cases, "backspin", 1.5);
  add_incline(cases, "incline_rolling");
  add_incline(cases, "incline_sliding");
  add_incline(cases, "incline_hollow");
  add_stack(cases);
  return cases;
}

}  // namespace collidoscope

// Cases with lasting or repeated contact: rebounds, friction, a stack. All are of first order in h, like
// Moreau's scheme, except for the penetration of soft contacts. The error constants follow from the solver
// and are derived at each case.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim_cuda/reference/analytic_cases.h"
#include "sim_cuda/reference/impacts.h"
#include "sim_cuda/solver/soft_contact.h"

namespace collidoscope {
namespace {

double gravity(const Scene& scene) { return -scene.physics.gravity.z(); }

Rebounds rebounds(const Scene& scene) {
  const Body& ball = scene.bodies[0];
  return {gravity(scene), ball.position.z() - ball.radius, scene.materials[0].restitution};
}

/// Semi-implicit Euler follows a parabola whose initial speed is lower by g h/2. An impact at the true speed
/// p therefore bounces like one at p - g h/2 (from v^2 + 2 g s with the true v and the parabola's s).
/// A speed u after a bounce becomes e (u - g h) after the next one. The deficit is eps_1 = e g h/2, eps_(n+1)
/// = e (eps_n + g h).
/// A flight is shorter by 2 (eps + g h/2) / g. A bounce is late by up to h, because it happens at the end of
/// a step.
struct EulerRebounds {
  double h, slow, early;  ///< s; m/s, deficit after the n-th bounce; s, bound of the timing error

  EulerRebounds(const Rebounds& ball, int n, double step)
      : h(step), slow(ball.e * ball.gravity * h / 2), early(h / 2) {
    for (int k = 1; k < n; ++k) {
      early += 2 * slow / ball.gravity + h;
      slow = ball.e * (slow + ball.gravity * h);
    }
  }
};

void add_bouncing(std::vector<AnalyticCase>& cases) {
  AnalyticCase one;
  one.name = "bouncing";
  one.scene = analytic_scene("bouncing");
  one.compared = "height after three bounces, m";
  one.rationale = "Euler: speed error of g h per flight; each bounce is up to h late, at the end of its step";
  one.horizon = 2.3;
  one.scale = 5;
  const Rebounds ball = rebounds(one.scene);
  const double t = one.horizon, r = one.scene.bodies[0].radius;
  const int n = ball.impacts(t);
  const Theory of_euler{Claim::bound, 1, [=](double h) {
                          const EulerRebounds off(ball, n, h);
                          return (off.slow + ball.gravity * h / 2) * (t - ball.time(n)) +
                                 ball.speed(n) * off.early;
                        }};
  // The other integrators follow the exact parabola; their bounces are equally late.
  const Theory of_others{Claim::bound, 1, [=](double h) { return ball.speed(n) * n * h; }};
  one.methods = {{Integrator::semi_implicit_euler, of_euler},
                 {Integrator::velocity_verlet, of_others},
                 {Integrator::rk4, of_others}};
  one.error = [=](World& world, int steps) {
    world.step(steps);
    return std::abs(world.bodies().position[0].z() - r - ball.height(t));
  };
  cases.push_back(one);
}

/// Approaches slower than 2 g h do not bounce. At most log(v_1 / 2 g h) / log(1/e) + 1 bounces remain. Each
/// is off as in EulerRebounds, where eps stays below e g h / (1 - e).
/// The missing infinite sequence takes 2 u e / (g (1 - e)), where u is the last rebound speed, below 3 g h.
/// The last contact takes two steps.
void add_zeno(std::vector<AnalyticCase>& cases) {
  AnalyticCase one;
  one.name = "zeno";
  one.scene = analytic_scene("zeno");
  one.compared = "time of rest, s";
  one.rationale = "no bounce below 2 g h; each earlier bounce is up to h late";
  one.horizon = 2;
  one.scale = 2;
  const Rebounds ball = rebounds(one.scene);
  const double r = one.scene.bodies[0].radius;
  one.methods = by_euler({Claim::bound, 1, [=](double h) {
                            const double ratio = ball.e / (1 - ball.e);
                            const double slowest = 2 * ball.gravity * h;
                            const double bounces =
                                1 + std::ceil(std::log(ball.first_speed() / slowest) / -std::log(ball.e));
                            return h * (0.5 + (bounces - 1) * (1 + 2 * ratio) + 6 * ratio + 2);
                          }});
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
void add_slide_to_roll(std::vector<AnalyticCase>& cases) {
  AnalyticCase one;
  one.name = "slide_to_roll";
  one.scene = analytic_scene("slide_to_roll");
  one.compared = "position, m";
  one.rationale = "error mu g h t/2 until the ball rolls at t = 2 v / (7 mu g): v h/7";
  one.horizon = 1;
  one.scale = 7;
  const Body ball = one.scene.bodies[0];
  const SlideToRoll slide{ball.velocity.x(), one.scene.materials[0].friction * gravity(one.scene)};
  one.methods = by_euler(leading_theory(1, slide.deceleration * slide.rolling_at() / 2));
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
  const double a = down_slope(gravity(one.scene), normal.x(), normal.z(), one.scene.materials[0].friction);
  const double t = one.horizon;
  one.methods = by_euler(leading_theory(1, a * t / 2));
  one.error = [=](World& world, int steps) {
    world.step(steps);
    return (world.bodies().position[0] - start - a * t * t / 2 * down).norm();
  };
  cases.push_back(one);
}

/// At rest, the spring of a soft contact carries the load: load = mass omega^2 depth. The effective mass of
/// two equal spheres is m/2, and omega = 2 pi/4 per substep. Below k spheres: depth = k m g / (m/2 omega^2).
void add_stack(std::vector<AnalyticCase>& cases) {
  AnalyticCase one;
  one.name = "stack_forces";
  one.scene = analytic_scene("stack");
  one.compared = "largest error of a force, relative to the weight above";
  one.rationale = "at rest the impulses equal the load for every step size";
  one.horizon = 10;
  one.scale = 5;
  const auto n = static_cast<int>(one.scene.bodies.size());
  const double g = gravity(one.scene);
  one.methods = by_euler({});
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
  one.rationale = "contacts compress by load / (mass omega^2), omega h = pi/2: 4 n (n - 1) g h^2 / pi^2";
  const double turn = 2 * std::numbers::pi * Softness<double>::cycles_per_substep;
  one.methods = by_euler(leading_theory(2, g * n * (n - 1) / (turn * turn)));
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
  add_slide_to_roll(cases);
  add_incline(cases, "incline_rolling");
  add_incline(cases, "incline_sliding");
  add_stack(cases);
  return cases;
}

}  // namespace collidoscope

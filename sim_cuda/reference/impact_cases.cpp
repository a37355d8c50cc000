// Impact cases, without gravity. An impact is resolved at the start of a step, at the positions at that time
// (solver/impact.h). Velocities change by the exact amount, but early. The error is of first order in h, like
// that of Moreau's scheme. The constants follow from the solver and are derived at each case.
// `impulse` resolves an impact at the end of the step, so it is late by as much as those of the other solvers
// are early.
//
// The time of an impact within a step matters as much as h. In these scenes it is the middle of a step, so
// impacts are h/2 early. Steps are divided by three, which keeps it there: (k + 1/2) 3 = 3k + 1 + 1/2.

#include <cmath>

#include "sim_cuda/reference/analytic_cases.h"
#include "sim_cuda/reference/impacts.h"

namespace collidoscope {
namespace {

constexpr std::initializer_list<Solver> solvers_of_impacts{Solver::soft_step, Solver::jacobi_split,
                                                           Solver::impulse};

/// Exact impact of two spheres: time, positions and velocities.
struct SphereImpact {
  double time;                  ///< s
  Vector3d at_a, at_b;          ///< m
  Vector3d normal;              ///< from a to b
  TwoVelocities before, after;  ///< m/s
  double share_a, share_b;      ///< share of a relative quantity: the other body's mass over the total

  explicit SphereImpact(const Scene& scene) {
    const Body &a = scene.bodies[0], &b = scene.bodies[1];
    const Vector3d d = b.position - a.position, u = b.velocity - a.velocity;
    const double reach = a.radius + b.radius, closing = d.dot(u);
    time = (-closing - std::sqrt(closing * closing - u.squaredNorm() * (d.squaredNorm() - reach * reach))) /
           u.squaredNorm();
    at_a = a.position + time * a.velocity;
    at_b = b.position + time * b.velocity;
    normal = (at_b - at_a) / reach;
    before = {a.velocity, b.velocity};
    after = after_impact(*a.mass, *b.mass, before, normal, scene.materials[0].restitution);
    share_a = *b.mass / (*a.mass + *b.mass);
    share_b = 1 - share_a;
  }
  /// Change of the relative velocity, m/s.
  double change() const { return ((after.b - after.a) - (before.b - before.a)).norm(); }
  /// Norm over both bodies of a change with the given relative magnitude.
  double both(double relative) const { return std::hypot(share_a, share_b) * relative; }

  double velocity_error(World& world, int steps) const {
    world.step(steps);
    const BodyStates s = world.bodies();
    return std::hypot((s.velocity[0] - after.a).norm(), (s.velocity[1] - after.b).norm());
  }
  double position_error(World& world, int steps, double horizon) const {
    world.step(steps);
    const BodyStates s = world.bodies();
    const double left = horizon - time;
    return std::hypot((s.position[0] - at_a - left * after.a).norm(),
                      (s.position[1] - at_b - left * after.b).norm());
  }
};

void add_head_on(std::vector<AnalyticCase>& cases, const char* name, const char* path) {
  AnalyticCase one;
  one.name = name;
  one.scene = analytic_scene(name);
  one.compared = "velocities, m/s";
  one.rationale = "Newton's law of restitution is exact for every time of impact";
  one.horizon = 0.5;
  one.refinement = 3;
  one.scale = 5;
  const SphereImpact impact(one.scene);
  one.methods = by_any_integrator({}, solvers_of_impacts);
  one.error = [=](World& world, int steps) { return impact.velocity_error(world, steps); };
  cases.push_back(one);

  // The relative velocity changes h/2 early, before the spheres touch.
  one.name = path;
  one.compared = "positions, m";
  one.rationale = "the impact is at the start of the step, h/2 early: error change of velocity times h/2";
  one.methods = by_any_integrator(leading_theory(1, impact.both(impact.change() / 2)), solvers_of_impacts);
  one.error = [=, horizon = one.horizon](World& world, int steps) {
    return impact.position_error(world, steps, horizon);
  };
  cases.push_back(one);
}

/// The line of centres turns at w = v_t / (r_a + r_b), where v_t is the tangential speed. The impulse acts
/// along its direction h/2 before contact, which differs by d = w h/2.
/// The change of the relative velocity u is -(1 + e) (u . n) n. For n turned by d, u . n changes by d v_t,
/// and n by d in the tangential direction. So the change is off by (1 + e) d (v_t, v_n), which is (1 + e) d
/// |u|.
void add_oblique(std::vector<AnalyticCase>& cases) {
  AnalyticCase one;
  one.name = "oblique";
  one.scene = analytic_scene("oblique");
  one.compared = "velocities, m/s";
  one.rationale =
      "the line of centres is taken h/2 early; it rotates by d = v_t / (r_a + r_b) h/2: error (1 + e) u d";
  one.horizon = 0.5;
  one.refinement = 3;
  one.scale = 5;
  const SphereImpact impact(one.scene);
  const Vector3d relative = impact.before.b - impact.before.a;
  const double across = (relative - relative.dot(impact.normal) * impact.normal).norm();
  const double reach = one.scene.bodies[0].radius + one.scene.bodies[1].radius;
  const double e = one.scene.materials[0].restitution;
  one.methods = by_any_integrator(
      leading_theory(1, impact.both((1 + e) * relative.norm() * across / (2 * reach))), solvers_of_impacts);
  one.error = [=](World& world, int steps) { return impact.velocity_error(world, steps); };
  cases.push_back(one);
}

void add_spinning_bounce(std::vector<AnalyticCase>& cases, const char* name, const char* path) {
  AnalyticCase one;
  one.name = name;
  one.scene = analytic_scene(name);
  one.compared = "velocity and spin times radius, m/s";
  one.rationale = "Coulomb's law is exact for the total impulse of the bounce";
  one.horizon = 0.5;
  one.refinement = 3;
  one.scale = 20;
  const Body ball = one.scene.bodies[0];
  const Material& material = one.scene.materials[0];
  const Motion3 after = after_bounce({ball.velocity, ball.angular_velocity}, ball.radius, Vector3d(0, 0, 1),
                                     material.restitution, material.friction);
  one.methods = by_any_integrator({});
  one.error = [=](World& world, int steps) {
    world.step(steps);
    const BodyStates s = world.bodies();
    return std::hypot((s.velocity[0] - after.velocity).norm(),
                      ball.radius * (s.angular_velocity[0] - after.spin).norm());
  };
  cases.push_back(one);

  one.name = path;
  one.compared = "position, m";
  one.rationale =
      "bounce and friction act at the start of the step, h/2 early, and at the surface: error h/2 times the "
      "normal velocity after the bounce and the change of the tangential one";
  const Vector3d tangential(ball.velocity.x(), ball.velocity.y(), 0);
  const double time = (ball.position.z() - ball.radius) / -ball.velocity.z();
  one.methods = by_any_integrator(leading_theory(1, (after.velocity - tangential).norm() / 2));
  one.error = [=, horizon = one.horizon](World& world, int steps) {
    world.step(steps);
    const Vector3d expected = ball.position + time * ball.velocity + (horizon - time) * after.velocity;
    return (world.bodies().position[0] - expected).norm();
  };
  cases.push_back(one);
}

/// A ball that is hit takes over the velocity at the start of the step. Gaps are k + 1/2 steps wide, so it
/// hits the next ball in the middle of a step again. Each impact moves the last ball h/2 ahead. The impacts
/// of touching balls are in the same step, and move it h/2 ahead together.
/// With `impulse`, each impact is h/2 late. Impacts of touching balls may fall in later steps, so it has no
/// theory for their path.
void add_cradle(std::vector<AnalyticCase>& cases, const char* name, const char* path) {
  AnalyticCase one;
  one.name = name;
  one.scene = analytic_scene(name);
  one.compared = "velocities, m/s";
  one.rationale = "equal spheres exchange their velocities";
  one.horizon = 0.75;
  one.refinement = 3;
  one.scale = 5;
  const std::vector<Body> balls = one.scene.bodies;
  const Vector3d v = balls[0].velocity;
  one.methods = by_any_integrator({}, solvers_of_impacts);
  one.error = [=](World& world, int steps) {
    world.step(steps);
    const BodyStates s = world.bodies();
    double squared = (s.velocity.back() - v).squaredNorm();
    for (std::size_t i = 0; i + 1 < s.velocity.size(); ++i) squared += s.velocity[i].squaredNorm();
    return std::sqrt(squared);
  };
  cases.push_back(one);

  one.name = path;
  one.compared = "position of the last sphere, m";
  one.rationale = "n impacts at different times are h/2 early each: error n v h/2";
  int n = 0;
  for (std::size_t i = 1; i < balls.size(); ++i)
    if (balls[i].position.x() - balls[i - 1].position.x() > balls[i].radius + balls[i - 1].radius) ++n;
  const Theory late = leading_theory(1, n * v.norm() / 2);
  one.methods = n + 1 == static_cast<int>(balls.size()) ? by_any_integrator(late, solvers_of_impacts)
                                                        : by_any_integrator(late);
  one.error = [=, horizon = one.horizon](World& world, int steps) {
    world.step(steps);
    double gaps = 0;  // total width of the gaps
    for (std::size_t i = 1; i < balls.size(); ++i)
      gaps += balls[i].position.x() - balls[i - 1].position.x() - balls[i].radius - balls[i - 1].radius;
    const double expected = balls.back().position.x() + v.x() * horizon - gaps;
    return std::abs(world.bodies().position.back().x() - expected);
  };
  cases.push_back(one);
}

}  // namespace

std::vector<AnalyticCase> impact_cases() {
  std::vector<AnalyticCase> cases;
  add_head_on(cases, "head_on", "head_on_path");
  add_head_on(cases, "head_on_1_to_3", "head_on_1_to_3_path");
  add_oblique(cases);
  add_spinning_bounce(cases, "spinning_bounce", "spinning_bounce_path");
  add_spinning_bounce(cases, "gripping_bounce", "gripping_bounce_path");
  add_cradle(cases, "cradle", "cradle_path");
  add_cradle(cases, "cradle_touching", "cradle_touching_path");
  return cases;
}

}  // namespace collidoscope

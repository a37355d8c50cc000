// Impact cases. A collision is solved once per step, at the positions at the start of the step. The error is
// of first order in h, like Moreau's scheme. The constants follow from the solver and are derived at each
// case.
// The time of an impact within a step matters as much as h. In these scenes it is the middle of a step. Steps
// are divided by three, which keeps it there: (k + 1/2) 3 = 3k + 1 + 1/2.

#include <cmath>

#include "sim_cuda/reference/analytic_cases.h"
#include "sim_cuda/reference/impacts.h"

namespace collidoscope {
namespace {

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

void add_head_on(std::vector<AnalyticCase>& cases) {
  AnalyticCase one;
  one.name = "head_on";
  one.scene = analytic_scene("head_on");
  one.compared = "velocities, m/s";
  one.rationale = "Newton's law of restitution is exact for every time of impact";
  one.horizon = 0.5;
  one.refinement = 3;
  one.scale = 5;
  const SphereImpact impact(one.scene);
  one.methods = by_euler({});
  one.error = [=](World& world, int steps) { return impact.velocity_error(world, steps); };
  cases.push_back(one);

  // The spheres touch h/2 into a step and bounce at its end: the bounce is late by h/2.
  one.name = "head_on_path";
  one.compared = "positions, m";
  one.rationale = "the bounce is at the end of the step, h/2 late: error separation speed times h/2";
  const double parting = (impact.after.b - impact.after.a).norm();
  one.methods = by_euler(leading_theory(1, impact.both(parting / 2)));
  one.error = [=, horizon = one.horizon](World& world, int steps) {
    return impact.position_error(world, steps, horizon);
  };
  cases.push_back(one);
}

/// The line of centres turns at w = v_t / (r_a + r_b), where v_t is the tangential speed.
/// Half of the stopping impulse acts along the line h/2 before contact, the rest along the line h/2 after it.
/// Their tangential errors cancel except for the restitution part. The separation speed e v_n acts along the
/// later line.
/// The relative velocity after the impact is therefore the exact one rotated by w h/2.
void add_oblique(std::vector<AnalyticCase>& cases) {
  AnalyticCase one;
  one.name = "oblique";
  one.scene = analytic_scene("oblique");
  one.compared = "velocities, m/s";
  one.rationale = "the line of centres is evaluated h/2 late; it rotates by v_t / (r_a + r_b) h/2";
  one.horizon = 0.5;
  one.refinement = 3;
  one.scale = 5;
  const SphereImpact impact(one.scene);
  const Vector3d relative = impact.before.b - impact.before.a;
  const double across = (relative - relative.dot(impact.normal) * impact.normal).norm();
  const double reach = one.scene.bodies[0].radius + one.scene.bodies[1].radius;
  const double parting = (impact.after.b - impact.after.a).norm();
  one.methods = by_euler(leading_theory(1, impact.both(parting * across / (2 * reach))));
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
  one.methods = by_euler({});
  one.error = [=](World& world, int steps) {
    world.step(steps);
    const BodyStates s = world.bodies();
    return std::hypot((s.velocity[0] - after.velocity).norm(),
                      ball.radius * (s.angular_velocity[0] - after.spin).norm());
  };
  cases.push_back(one);

  // The sphere reaches the floor h/2 into a step, which ends on the floor. The tangential velocity is
  // unchanged until then.
  one.name = path;
  one.compared = "position, m";
  one.rationale = "bounce and friction act at the end of the step, h/2 late";
  const double time = (ball.position.z() - ball.radius) / -ball.velocity.z();
  const Vector3d missed = after.velocity - Vector3d(ball.velocity.x(), ball.velocity.y(), 0);
  one.methods = by_euler(leading_theory(1, missed.norm() / 2));
  one.error = [=, horizon = one.horizon](World& world, int steps) {
    world.step(steps);
    const Vector3d expected = ball.position + time * ball.velocity + (horizon - time) * after.velocity;
    return (world.bodies().position[0] - expected).norm();
  };
  cases.push_back(one);
}

/// A ball is hit when the fraction f of a step has passed. It moves half of v (1 - f) h until the step ends,
/// because the solver splits the closing of the gap between both balls.
/// It is late by (1 - f) h/2. Gaps are n + 1/2 steps wide, so it hits the next ball at f/2. Starting from f =
/// 1/2, n collisions add up to h/2 (n - 1 + 2^-n).
void add_cradle(std::vector<AnalyticCase>& cases) {
  AnalyticCase one;
  one.name = "cradle";
  one.scene = analytic_scene("cradle");
  one.compared = "velocities, m/s";
  one.rationale = "equal spheres exchange their velocities";
  one.horizon = 0.75;
  one.refinement = 3;
  one.scale = 5;
  const std::vector<Body> balls = one.scene.bodies;
  const Vector3d v = balls[0].velocity;
  one.methods = by_euler({});
  one.error = [=](World& world, int steps) {
    world.step(steps);
    const BodyStates s = world.bodies();
    double squared = (s.velocity.back() - v).squaredNorm();
    for (std::size_t i = 0; i + 1 < s.velocity.size(); ++i) squared += s.velocity[i].squaredNorm();
    return std::sqrt(squared);
  };
  cases.push_back(one);

  one.name = "cradle_path";
  one.compared = "position of the last sphere, m";
  one.rationale = "each of n collisions is late: h/2 (n - 1 + 2^-n) in total";
  const auto n = static_cast<double>(balls.size() - 1);
  one.methods = by_euler(leading_theory(1, v.norm() / 2 * (n - 1 + std::exp2(-n))));
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
  add_head_on(cases);
  add_oblique(cases);
  add_spinning_bounce(cases, "spinning_bounce", "spinning_bounce_path");
  add_spinning_bounce(cases, "gripping_bounce", "gripping_bounce_path");
  add_cradle(cases);
  return cases;
}

}  // namespace collidoscope

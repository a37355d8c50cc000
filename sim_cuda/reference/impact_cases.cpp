// Impacts. A collision is solved once in a step, at places that the step had before it: of first order in h,
// as Moreau's scheme is, with constants that follow from what the solver does, each derived beside its case.
// Where an impact falls within a step matters as much as h: in these scenes it falls in the middle, and steps
// are divided by three, for (k + 1/2) 3 = 3k + 1 + 1/2.

#include <cmath>

#include "sim_cuda/reference/analytic_cases.h"
#include "sim_cuda/reference/impacts.h"

namespace collidoscope {
namespace {

/// Two spheres that meet: when, where, and what comes of it.
struct SphereImpact {
  double time;                  ///< s
  Vector3d at_a, at_b;          ///< m
  Vector3d normal;              ///< from a to b
  TwoVelocities before, after;  ///< m/s
  double share_a, share_b;      ///< of what is relative: the other's mass over both

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
  /// How large what is relative is in both bodies together.
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
  one.rationale = "Newton's law holds whenever they meet";
  one.horizon = 0.5;
  one.refinement = 3;
  one.scale = 5;
  const SphereImpact impact(one.scene);
  one.methods = by_euler({});
  one.error = [=](World& world, int steps) { return impact.velocity_error(world, steps); };
  cases.push_back(one);

  // They touch h/2 into a step, at whose end they still touch: the bounce is h/2 late.
  one.name = "head_on_path";
  one.compared = "positions, m";
  one.rationale = "the bounce comes at the step's end, h/2 late: the speed of parting times that";
  const double parting = (impact.after.b - impact.after.a).norm();
  one.methods = by_euler(leading_theory(1, impact.both(parting / 2)));
  one.error = [=, horizon = one.horizon](World& world, int steps) {
    return impact.position_error(world, steps, horizon);
  };
  cases.push_back(one);
}

/// What is relative turns about with the line of centres, at w = v_t / (r_a + r_b), v_t across the line. Half
/// of the stop is given along the line of h/2 before they touch, all else along that of h/2 after: the
/// impulses' errors across cancel but for the bounce's own part, and the speed of parting e v_n is had along
/// the later line. So the parting velocity is the true one turned by w h/2.
void add_oblique(std::vector<AnalyticCase>& cases) {
  AnalyticCase one;
  one.name = "oblique";
  one.scene = analytic_scene("oblique");
  one.compared = "velocities, m/s";
  one.rationale = "the line of centres is read h/2 late: it turns by v_t / (r_a + r_b) h/2";
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
  one.rationale = "Coulomb's law holds over the whole bounce";
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

  // The floor is met h/2 into a step, which ends on it; until then nothing is changed across.
  one.name = path;
  one.compared = "position, m";
  one.rationale = "bounce and friction come at the step's end, h/2 late";
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

/// A ball that is hit with the fraction f of a step gone, rather than v (1 - f) h, moves half as far until
/// the step ends: for the solver shares out the closing of the gap. It is late by (1 - f) h/2, and, gaps
/// being n + 1/2 steps wide, meets the next one at f/2. From f = 1/2 on, n collisions make h/2 (n - 1 +
/// 2^-n).
void add_cradle(std::vector<AnalyticCase>& cases) {
  AnalyticCase one;
  one.name = "cradle";
  one.scene = analytic_scene("cradle");
  one.compared = "velocities, m/s";
  one.rationale = "equal spheres swap their velocities";
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
  one.compared = "position of the last, m";
  one.rationale = "each of n collisions passes the motion on late: h/2 (n - 1 + 2^-n) in all";
  const auto n = static_cast<double>(balls.size() - 1);
  one.methods = by_euler(leading_theory(1, v.norm() / 2 * (n - 1 + std::exp2(-n))));
  one.error = [=, horizon = one.horizon](World& world, int steps) {
    world.step(steps);
    double gaps = 0;  // that are closed one after the other
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

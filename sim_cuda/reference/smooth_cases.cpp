// Motion without contacts, where every integrator shows its order: x'' = a(x), drag, free rotation. What
// their errors come to is leading_error.h's, from the closed form and one step of the method as books write
// it. Joints of one rod belong here too: solved with the kick in front, they are semi-implicit Euler along
// the circle, to first order.

#include <cmath>
#include <numbers>

#include "sim_cuda/dynamics/drag.h"
#include "sim_cuda/reference/analytic_cases.h"
#include "sim_cuda/reference/free_rotation.h"
#include "sim_cuda/reference/kepler.h"
#include "sim_cuda/reference/leading_error.h"
#include "sim_cuda/reference/oscillations.h"
#include "sim_cuda/reference/slowing.h"

namespace collidoscope {
namespace {

/// What of a state is compared.
using View = std::function<SmoothState(const SmoothState&)>;

SmoothState whole(const SmoothState& y) { return y; }

Theory theory(const SmoothProblem& problem, const OneStep& step, int order, double time, const View& view) {
  const SmoothState end = problem.exact(time), off = leading_error(problem, step, order, time);
  const double small = 1e-4 * end.norm() / off.norm();
  const double constant = ((view(end + small * off) - view(end - small * off)) / (2 * small)).norm();
  return {Claim::leading, static_cast<double>(order),
          [=](double h) { return constant * std::pow(h, order); }};
}

/// Of x'' = a(x).
std::vector<AnalyticMethod> all_methods(const SmoothProblem& problem, const Rate& acceleration, double time,
                                        const View& view) {
  return {{Integrator::semi_implicit_euler, theory(problem, euler_step(acceleration), 1, time, view)}};
}

SmoothState joined(const Vector3d& x, const Vector3d& v) {
  SmoothState y(6);
  y << x, v;
  return y;
}

/// Steps, and compares one body's (x, v) with the end of `problem`.
std::function<double(World&, int)> against(const SmoothProblem& problem, double time, const View& view) {
  return [=, end = view(problem.exact(time))](World& world, int steps) {
    world.step(steps);
    const BodyStates s = world.bodies();
    return (view(joined(s.position[0], s.velocity[0])) - end).norm();
  };
}

AnalyticCase ballistic_flight() {
  AnalyticCase one;
  one.name = "ballistic_flight";
  one.scene = analytic_scene(one.name);
  one.compared = "position, m";
  one.because = "the parabola with the speed of the step's end: g h t/2";
  one.horizon = 2;
  one.scale = 25;
  const Body ball = one.scene.bodies[0];
  const Vector3d g = one.scene.physics.gravity;
  const double t = one.horizon;
  one.methods = {
      {Integrator::semi_implicit_euler, {Claim::leading, 1, [=](double h) { return g.norm() * t / 2 * h; }}}};
  one.error = [=](World& world, int steps) {
    world.step(steps);
    return (world.bodies().position[0] - ball.position - t * ball.velocity - t * t / 2 * g).norm();
  };
  return one;
}

AnalyticCase spring_force() {
  AnalyticCase one;
  one.name = "spring_force";
  one.scene = analytic_scene(one.name);
  one.compared = "position and speed over w, m";
  one.because = "half a kick ahead at the start, half a kick late at the end: A w h/2 |sin w t|";
  one.horizon = 1.5;
  const Attractor pull = one.scene.physics.attractors[0];
  const double w = std::sqrt(pull.strength / std::pow(pull.softening, 3));
  const Vector3d first = one.scene.bodies[0].position;
  one.scale = first.norm() * w * one.horizon;
  const Rate acceleration = [=](const SmoothState& x) { return SmoothState(-w * w * x); };
  const SmoothProblem problem{second_order_rate(acceleration),
                              [=](double t) {
                                const Oscillation s = damped_oscillation(w, 0, t);
                                return joined(s.at * first, s.rate * first);
                              },
                              w};
  const View view = [=](const SmoothState& y) { return joined(y.head(3), y.tail(3) / w); };
  one.methods = all_methods(problem, acceleration, one.horizon, view);
  one.error = against(problem, one.horizon, view);
  return one;
}

AnalyticCase orbit() {
  AnalyticCase one;
  one.name = "orbit";
  one.scene = analytic_scene(one.name);
  one.compared = "position, m";
  one.because = "half a kick ahead at the start, half a kick late at the end, along Kepler's motion";
  one.horizon = 50000;
  const double mu = one.scene.physics.attractors[0].strength;
  const Body& moon = one.scene.bodies[0];
  const OrbitState start{moon.position, moon.velocity};
  const double nearest = moon.position.norm(), fastest = moon.velocity.norm() / nearest;
  one.scale = nearest * fastest * one.horizon;
  const Rate acceleration = [=](const SmoothState& x) {
    return SmoothState(-mu / std::pow(x.norm(), 3) * x);
  };
  // In units of the nearest distance, so that speeds weigh as much as places.
  const SmoothProblem problem{second_order_rate(acceleration),
                              [=](double t) {
                                const OrbitState s = kepler_orbit(mu, start, t);
                                return joined(s.position, s.velocity);
                              },
                              fastest};
  const View view = [](const SmoothState& y) { return SmoothState(y.head(3)); };
  one.methods = all_methods(problem, acceleration, one.horizon, view);
  one.error = against(problem, one.horizon, view);
  return one;
}

AnalyticCase slowed(const char* name, const char* because) {
  AnalyticCase one;
  one.name = name;
  one.scene = analytic_scene(one.name);
  one.compared = "velocity, m/s";
  one.because = because;
  one.horizon = 1;
  const Body ball = one.scene.bodies[0];
  const auto medium = DragLaw<double>::of(one.scene.physics.drag);
  const double r = ball.radius, m = *ball.mass, v0 = ball.velocity.norm(), t = one.horizon;
  const Slowing law{medium.linear * r / m, medium.quadratic * r * r / m};
  one.scale = v0;
  const SmoothProblem problem{[=](const SmoothState& v) { return SmoothState::Constant(1, law.rate(v[0])); },
                              [=](double s) { return SmoothState::Constant(1, law.speed(v0, s)); },
                              law.linear + law.quadratic * v0};
  // v' (1 + a h) + b h v'^2 = v.
  const OneStep implicit_euler = [=](const SmoothState& v, double h) {
    const double a = 1 + law.linear * h;
    return SmoothState::Constant(1, 2 * v[0] / (a + std::sqrt(a * a + 4 * law.quadratic * h * v[0])));
  };
  one.methods = {{Integrator::semi_implicit_euler, theory(problem, implicit_euler, 1, t, whole)}};
  one.error = [=](World& world, int steps) {
    world.step(steps);
    return (world.bodies().velocity[0] - law.speed(v0, t) / v0 * ball.velocity).norm();
  };
  return one;
}

AnalyticCase swinging(const char* name, const char* because, double horizon) {
  AnalyticCase one;
  one.name = name;
  one.scene = analytic_scene(one.name);
  one.compared = "angle, rad";
  one.because = because;
  one.horizon = horizon;
  const Vector3d first = one.scene.bodies[0].position;
  const double w = std::sqrt(-one.scene.physics.gravity.z() / first.norm());
  const double amplitude = std::atan2(first.x(), -first.z());
  one.scale = std::abs(amplitude) * w * horizon;
  const Rate acceleration = [=](const SmoothState& angle) {
    return SmoothState::Constant(1, -w * w * std::sin(angle[0]));
  };
  const SmoothProblem problem{second_order_rate(acceleration),
                              [=](double t) {
                                const Oscillation s = pendulum(w, amplitude, t);
                                SmoothState y(2);
                                y << s.at, s.rate;
                                return y;
                              },
                              w};
  const View view = [](const SmoothState& y) { return SmoothState(y.head(1)); };
  one.methods = {
      {Integrator::semi_implicit_euler, theory(problem, euler_step(acceleration), 1, horizon, view)}};
  one.error = [=, end = problem.exact(horizon)[0]](World& world, int steps) {
    world.step(steps);
    const Vector3d x = world.bodies().position[0];
    return std::abs(std::remainder(std::atan2(x.x(), -x.z()) - end, 2 * std::numbers::pi));
  };
  return one;
}

// ---- free rotation ----

SmoothState parts(const Quaterniond& q) { return SmoothState(q.coeffs()); }
Quaterniond turn(const SmoothState& y) { return Quaterniond(Eigen::Vector4d(y)); }

/// The angular velocity, world axes, of a body of the angular momentum L at q; q need not be of unit length.
Vector3d turning(const Quaterniond& q, const Vector3d& inertia, const Vector3d& momentum) {
  const Quaterniond unit = q.normalized();
  return unit * Vector3d((unit.conjugate() * momentum).cwiseQuotient(inertia));
}

AnalyticCase free_top() {
  AnalyticCase one;
  one.name = "symmetric_top";
  one.scene = analytic_scene(one.name);
  one.compared = "orientation, rad";
  one.because = "it turns about where w was when the step began, while w goes round L";
  one.horizon = 1.5;
  const Body& top = one.scene.bodies[0];
  const Vector3d inertia = *top.inertia, spin = top.angular_velocity, momentum = inertia.cwiseProduct(spin);
  one.scale = spin.norm() * one.horizon;
  const Rate rate = [=](const SmoothState& y) {
    const Quaterniond q = turn(y);
    const Vector3d w = turning(q, inertia, momentum) / 2;
    return parts(Quaterniond(0, w.x(), w.y(), w.z()) * q);
  };
  const OneStep cayley = [=](const SmoothState& y, double h) {
    const Quaterniond q = turn(y);
    const Vector3d half = h / 2 * turning(q, inertia, momentum);
    return parts((Quaterniond(1, half.x(), half.y(), half.z()) * q).normalized());
  };
  const SmoothProblem problem{rate, [=](double t) { return parts(symmetric_top(inertia, spin, t)); },
                              spin.norm()};
  const View view = [](const SmoothState& y) { return SmoothState(2 * y); };  // half angles are in q
  one.methods = {{Integrator::semi_implicit_euler, theory(problem, cayley, 1, one.horizon, view)}};
  one.error = [=, end = problem.exact(one.horizon)](World& world, int steps) {
    world.step(steps);
    const SmoothState q = parts(world.bodies().orientation[0]);
    return 2 * std::min((q - end).norm(), (q + end).norm());
  };
  return one;
}

AnalyticCase middle_axis() {
  AnalyticCase one;
  one.name = "middle_axis";
  one.scene = analytic_scene(one.name);
  one.compared = "spin along the body's axes, rad/s";
  one.because = "it turns about where w was when the step began; near the middle axis that grows";
  one.horizon = 4;
  const Body& body = one.scene.bodies[0];
  const Vector3d inertia = *body.inertia, spin = body.angular_velocity;
  one.scale = spin.norm() * spin.norm() * one.horizon;
  const Rate euler_equations = [=](const SmoothState& y) {
    const Vector3d w = y.head<3>(), moment = inertia.cwiseProduct(w);
    return SmoothState(Vector3d(moment.cross(w).cwiseQuotient(inertia)));
  };
  // What turns the body by q turns L by its inverse, as the body sees it.
  const OneStep cayley = [=](const SmoothState& y, double h) {
    const Vector3d w = y.head<3>(), half = h / 2 * w;
    const Quaterniond q = Quaterniond(1, half.x(), half.y(), half.z()).normalized();
    return SmoothState(Vector3d((q.conjugate() * inertia.cwiseProduct(w)).cwiseQuotient(inertia)));
  };
  const SmoothProblem problem{euler_equations,
                              [=](double t) { return SmoothState(middle_axis_spin(inertia, spin, t)); },
                              spin.norm()};
  one.methods = {{Integrator::semi_implicit_euler, theory(problem, cayley, 1, one.horizon, whole)}};
  one.error = [=, end = Vector3d(problem.exact(one.horizon))](World& world, int steps) {
    world.step(steps);
    const BodyStates s = world.bodies();
    return (s.orientation[0].conjugate() * s.angular_velocity[0] - end).norm();
  };
  return one;
}

}  // namespace

std::vector<AnalyticCase> smooth_cases() {
  return {ballistic_flight(),
          spring_force(),
          orbit(),
          slowed("drag_linear", "implicit: k^2 v h t/2 at the rate k"),
          slowed("drag_quadratic", "implicit: b v^2 log(1 + b v0 t) h"),
          free_top(),
          middle_axis(),
          swinging("pendulum_small", "half a kick ahead at the start, half a kick late at the end", 1.5),
          swinging("pendulum_large", "the same, along the elliptic function", 2)};
}

}  // namespace collidoscope

// Cases without contacts, where every integrator shows its order: x'' = a(x), drag, free rotation.
// leading_error.h computes the theoretical errors from the closed form and one textbook step of the method.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sim_cuda/reference/analytic_cases.h"
#include "sim_cuda/reference/drag_solution.h"
#include "sim_cuda/reference/free_rotation.h"
#include "sim_cuda/reference/kepler.h"
#include "sim_cuda/reference/leading_error.h"
#include "sim_cuda/reference/oscillations.h"

namespace collidoscope {
namespace {

SmoothState whole(const SmoothState& y) { return y; }

/// All integrators for x'' = a(x).
std::vector<AnalyticMethod> all_methods(const SmoothProblem& problem, const Rate& acceleration, double time,
                                        const ComparedPart& part) {
  return {{Integrator::semi_implicit_euler, smooth_theory(problem, euler_step(acceleration), 1, time, part)},
          {Integrator::velocity_verlet, smooth_theory(problem, verlet_step(acceleration), 2, time, part)},
          {Integrator::rk4, smooth_theory(problem, rk4_step(problem.rate), 4, time, part)}};
}

SmoothState joined(const Vector3d& x, const Vector3d& v) {
  SmoothState y(6);
  y << x, v;
  return y;
}

/// Error function: advances the world and compares one body's (x, v) with the exact state at `time`.
std::function<double(World&, int)> against(const SmoothProblem& problem, double time,
                                           const ComparedPart& part) {
  return [=, end = part(problem.exact(time))](World& world, int steps) {
    world.step(steps);
    const BodyStates s = world.bodies();
    return (part(joined(s.position[0], s.velocity[0])) - end).norm();
  };
}

void add_ballistic_flight(std::vector<AnalyticCase>& cases) {
  AnalyticCase one;
  one.name = "ballistic_flight";
  one.scene = analytic_scene("ballistic_flight");
  one.compared = "position, m";
  one.rationale =
      "Euler uses the velocity at the end of the step: error g h t/2; the others are exact for parabolas";
  one.horizon = 2;
  one.scale = 25;
  const Body ball = one.scene.bodies[0];
  const Vector3d g = one.scene.physics.gravity;
  const double t = one.horizon;
  const auto off = [=](World& world, int steps) {
    world.step(steps);
    return Vector3d(world.bodies().position[0] - ball.position - t * ball.velocity - t * t / 2 * g);
  };
  one.methods = {{Integrator::semi_implicit_euler, leading_theory(1, g.norm() * t / 2)},
                 {Integrator::velocity_verlet, {}},
                 {Integrator::rk4, {}}};
  one.error = [=](World& world, int steps) { return off(world, steps).norm(); };
  cases.push_back(one);

  one.name = "ballistic_bias";
  one.compared = "position minus g h t/2, m";
  one.rationale = "the error of Euler is exactly this bias";
  one.methods = {{Integrator::semi_implicit_euler, {}}};
  one.error = [=](World& world, int steps) { return (off(world, steps) - t * t / steps / 2 * g).norm(); };
  cases.push_back(one);
}

AnalyticCase spring_force() {
  AnalyticCase one;
  one.name = "spring_force";
  one.scene = analytic_scene(one.name);
  one.compared = "position and velocity / w, m";
  one.rationale =
      "Euler: velocity half a step early at the start, half a step late at the end: A sin(w t) w h/2";
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
  const ComparedPart part = [=](const SmoothState& y) { return joined(y.head(3), y.tail(3) / w); };
  one.methods = all_methods(problem, acceleration, one.horizon, part);
  one.error = against(problem, one.horizon, part);
  return one;
}

AnalyticCase orbit() {
  AnalyticCase one;
  one.name = "orbit";
  one.scene = analytic_scene(one.name);
  one.compared = "position, m";
  one.rationale = "Euler: the same, for Kepler's orbit";
  one.horizon = 25000;
  const double mu = one.scene.physics.attractors[0].strength;
  const Body& moon = one.scene.bodies[0];
  const OrbitState start{moon.position, moon.velocity};
  const double nearest = moon.position.norm(), fastest = moon.velocity.norm() / nearest;
  one.scale = nearest * fastest * one.horizon;
  const Rate acceleration = [=](const SmoothState& x) {
    return SmoothState(-mu / std::pow(x.norm(), 3) * x);
  };
  const SmoothProblem problem{second_order_rate(acceleration),
                              [=](double t) {
                                const OrbitState s = kepler_orbit(mu, start, t);
                                return joined(s.position, s.velocity);
                              },
                              fastest};
  const ComparedPart part = [](const SmoothState& y) { return SmoothState(y.head(3)); };
  one.methods = all_methods(problem, acceleration, one.horizon, part);
  one.error = against(problem, one.horizon, part);
  return one;
}

AnalyticCase slowed(const char* name, const char* rationale) {
  AnalyticCase one;
  one.name = name;
  one.scene = analytic_scene(one.name);
  one.compared = "velocity, m/s";
  one.rationale = rationale;
  one.horizon = 1;
  const Body ball = one.scene.bodies[0];
  const Drag& medium = one.scene.physics.drag;
  const double r = ball.radius, m = *ball.mass, v0 = ball.velocity.norm(), t = one.horizon;
  const DragSolution law{6 * std::numbers::pi * medium.viscosity * r / m,                          // Stokes
                         medium.density * medium.coefficient * std::numbers::pi * r * r / 2 / m};  // Newton
  one.scale = v0;
  const SmoothProblem problem{[=](const SmoothState& v) { return SmoothState::Constant(1, law.rate(v[0])); },
                              [=](double s) { return SmoothState::Constant(1, law.speed(v0, s)); },
                              law.linear + law.quadratic * v0};
  // Solves v' (1 + a h) + b h v'^2 = v.
  const OneStep implicit_euler = [=](const SmoothState& v, double h) {
    const double a = 1 + law.linear * h;
    return SmoothState::Constant(1, 2 * v[0] / (a + std::sqrt(a * a + 4 * law.quadratic * h * v[0])));
  };
  // Two half steps. Each uses the rate that implicit Euler finds at its middle, and 1/(1 + z + z^2/2) for
  // exp(-z).
  const OneStep second_order = [=](const SmoothState& v, double h) {
    SmoothState slow = v;
    for (int half = 0; half < 2; ++half) {
      const double z = (law.linear + law.quadratic * implicit_euler(slow, h / 4)[0]) * h / 2;
      slow /= 1 + z + z * z / 2;
    }
    return slow;
  };
  one.methods = {{Integrator::semi_implicit_euler, smooth_theory(problem, implicit_euler, 1, t, whole)},
                 {Integrator::velocity_verlet, smooth_theory(problem, second_order, 2, t, whole)},
                 {Integrator::rk4, smooth_theory(problem, rk4_step(problem.rate), 4, t, whole)}};
  one.error = [=](World& world, int steps) {
    world.step(steps);
    return (world.bodies().velocity[0] - law.speed(v0, t) / v0 * ball.velocity).norm();
  };
  return one;
}

// ---- free rotation ----

SmoothState parts(const Quaterniond& q) { return SmoothState(q.coeffs()); }
Quaterniond turn(const SmoothState& y) { return Quaterniond(Eigen::Vector4d(y)); }

/// One step of a free body: its rotation in its own axes, from its angular momentum in these axes.
using FreeTurn = std::function<Quaterniond(const Vector3d& inertia, const Vector3d& momentum, double h)>;

Quaterniond cayley_turn(const Vector3d& inertia, const Vector3d& momentum, double h) {
  const Vector3d half = h / 2 * momentum.cwiseQuotient(inertia);
  return Quaterniond(1, half.x(), half.y(), half.z()).normalized();
}

/// Half of the rest, symmetric top, half of the rest (dynamics/rotation_updates.h), with exact angles.
Quaterniond split_turn(const Vector3d& inertia, const Vector3d& momentum, double h) {
  const Vector3d a = inertia.cwiseInverse();
  int s = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(a[(k + 1) % 3] - a[(k + 2) % 3]) < std::abs(a[(s + 1) % 3] - a[(s + 2) % 3])) s = k;
  const int i = (s + 1) % 3, j = (s + 2) % 3;
  Quaterniond whole(1, 0, 0, 0);
  const auto rotate = [&](double angle, const Vector3d& axis) {
    whole = whole * Quaterniond(Eigen::AngleAxisd(angle, axis));
  };
  const auto now = [&] { return Vector3d(whole.conjugate() * momentum); };
  rotate(h / 2 * (a[j] - a[i]) * now()[j], Vector3d::Unit(j));
  rotate(h * momentum.norm() * a[i], now().normalized());
  rotate(h * now()[s] * (a[s] - a[i]), Vector3d::Unit(s));
  rotate(h / 2 * (a[j] - a[i]) * now()[j], Vector3d::Unit(j));
  return whole;
}

/// Five of those steps, after Suzuki (1990).
Quaterniond composed_turn(const Vector3d& inertia, const Vector3d& momentum, double h) {
  const double outer = 1 / (4 - std::cbrt(4.0));
  Quaterniond whole(1, 0, 0, 0);
  for (const double share : {outer, outer, 1 - 4 * outer, outer, outer})
    whole = whole * split_turn(inertia, whole.conjugate() * momentum, share * h);
  return whole;
}

/// `turns`, and then a rotation that restores the energy: along its gradient, by Newton's method.
FreeTurn with_energy_of_start(const FreeTurn& turns) {
  return [=](const Vector3d& inertia, const Vector3d& momentum, double h) {
    const auto twice_energy = [&](const Vector3d& l) { return l.dot(l.cwiseQuotient(inertia)); };
    Quaterniond whole = turns(inertia, momentum, h);
    for (int k = 0; k < 4; ++k) {
      const Vector3d l = whole.conjugate() * momentum, axis = l.cross(l.cwiseQuotient(inertia));
      const double angle = (twice_energy(momentum) - twice_energy(l)) / (2 * axis.norm());
      whole = whole * Quaterniond(Eigen::AngleAxisd(-angle, axis.normalized()));
    }
    return whole;
  };
}

/// Both rotation updates, and lie_group with every integrator. `lie_group(p)` is its theory of order p.
std::vector<AnalyticMethod> all_turns(const Theory& first_order,
                                      const std::function<Theory(int)>& lie_group) {
  return {{Integrator::semi_implicit_euler, first_order, RotationUpdate::first_order},
          {Integrator::semi_implicit_euler, lie_group(2)},
          {Integrator::velocity_verlet, lie_group(2)},
          {Integrator::rk4, lie_group(4)}};
}

AnalyticCase free_top(const char* name) {
  AnalyticCase one;
  one.name = name;
  one.scene = analytic_scene(one.name);
  one.compared = "orientation, rad";
  one.rationale = "first_order rotates about w at the start of the step, but w precesses about L";
  one.horizon = 1.5;
  const Body& top = one.scene.bodies[0];
  const Vector3d inertia = *top.inertia, spin = top.angular_velocity, momentum = inertia.cwiseProduct(spin);
  one.scale = spin.norm() * one.horizon;
  const Rate rate = [=](const SmoothState& y) {
    const Quaterniond q = turn(y), unit = q.normalized();
    const Vector3d w = Vector3d((unit.conjugate() * momentum).cwiseQuotient(inertia)) / 2;
    return parts(q * Quaterniond(0, w.x(), w.y(), w.z()));
  };
  const auto step = [=](const FreeTurn& turns) -> OneStep {
    return [=](const SmoothState& y, double h) {
      const Quaterniond q = turn(y);
      return parts(q * turns(inertia, q.conjugate() * momentum, h));
    };
  };
  const SmoothProblem problem{rate, [=](double t) { return parts(symmetric_top(inertia, spin, t)); },
                              spin.norm()};
  // q contains half angles
  const ComparedPart part = [](const SmoothState& y) { return SmoothState(2 * y); };
  one.methods = all_turns(smooth_theory(problem, step(cayley_turn), 1, one.horizon, part),
                          [](int) { return Theory{}; });
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
  one.compared = "angular velocity in body axes, rad/s";
  one.rationale = "the same; near the intermediate axis errors grow";
  one.horizon = 3;
  const Body& body = one.scene.bodies[0];
  const Vector3d inertia = *body.inertia, spin = body.angular_velocity;
  one.scale = spin.norm() * spin.norm() * one.horizon;
  const Rate euler_equations = [=](const SmoothState& y) {
    const Vector3d w = y.head<3>(), moment = inertia.cwiseProduct(w);
    return SmoothState(Vector3d(moment.cross(w).cwiseQuotient(inertia)));
  };
  // In body axes, L rotates opposite to the body.
  const auto step = [=](const FreeTurn& turns) -> OneStep {
    return [=](const SmoothState& y, double h) {
      const Vector3d momentum = inertia.cwiseProduct(Vector3d(y.head<3>()));
      return SmoothState(
          Vector3d((turns(inertia, momentum, h).conjugate() * momentum).cwiseQuotient(inertia)));
    };
  };
  const SmoothProblem problem{euler_equations,
                              [=](double t) { return SmoothState(middle_axis_spin(inertia, spin, t)); },
                              euler_equations(spin).norm() / spin.norm()};
  one.methods =
      all_turns(smooth_theory(problem, step(cayley_turn), 1, one.horizon, whole), [=, &one](int order) {
        const FreeTurn turns = with_energy_of_start(order == 4 ? composed_turn : split_turn);
        return smooth_theory(problem, step(turns), order, one.horizon, whole);
      });
  one.error = [=, end = Vector3d(problem.exact(one.horizon))](World& world, int steps) {
    world.step(steps);
    const BodyStates s = world.bodies();
    return (s.orientation[0].conjugate() * s.angular_velocity[0] - end).norm();
  };
  return one;
}

/// Free motion is the same with `impulse`, which has no attractors.
void add_impulse(AnalyticCase& one) {
  if (!one.scene.physics.attractors.empty()) return;
  const std::vector<AnalyticMethod> methods = one.methods;
  for (AnalyticMethod method : methods) {
    method.solver = Solver::impulse;
    one.methods.push_back(method);
  }
}

}  // namespace

std::vector<AnalyticCase> smooth_cases() {
  std::vector<AnalyticCase> cases;
  add_ballistic_flight(cases);
  for (const AnalyticCase& one :
       {spring_force(), orbit(), slowed("drag_linear", "Euler's drag is implicit: k^2 v h t/2 at the rate k"),
        slowed("drag_quadratic", "Euler's drag is implicit: b v^2 log(1 + b v0 t) h"),
        free_top("symmetric_top"), free_top("oblate_top"), middle_axis()})
    cases.push_back(one);
  for (AnalyticCase& one : cases) add_impulse(one);
  return cases;
}

}  // namespace collidoscope

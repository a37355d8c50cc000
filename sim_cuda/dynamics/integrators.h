#pragma once
// Integrators of free motion, for bodies without contacts in a substep. The forces are smooth functions of
// position and velocity: gravity, attractors, drag. Each integrator returns two velocities: the mean velocity
// over h, and the final velocity. Semi-implicit Euler, for which both are equal, is in move.h.
//
//   velocity_verlet  kick h/2, drift, kick h/2. Second order; symplectic without drag (Hairer, Lubich,
//                    Wanner, "Geometric Numerical Integration", I.1.4).
//   rk4              the classical Runge-Kutta method, fourth order. It is explicit, so a body that drag
//                    stops within about a step uses velocity_verlet instead, whose kicks are implicit.
//
// Both integrate a parabola exactly. Pure functions of SI units, without libm, as all code that affects the
// state. Coefficients are template arguments, so that tests can inject wrong ones.

#include "sim_cuda/dynamics/attractor.h"
#include "sim_cuda/dynamics/drag.h"

namespace collidoscope {

/// Forces on a free body.
template <class Real>
struct SmoothForces {
  AttractorView<Real> attractors;  ///< none if the effect is off
  DragLaw<Real> drag;
  bool with_drag;             ///< whether the effect drag is on
  Vector3<Real> gravity;      ///< m/s^2
  Real radius, inverse_mass;  ///< m, 1/kg

  /// Acceleration by all forces except drag, m/s^2.
  SIM_HD Vector3<Real> field(const Vector3<Real>& x) const {
    Vector3<Real> sum = gravity;
    for (int k = 0; k < attractors.count; ++k) sum += attractors.points[k].acceleration(x);
    return sum;
  }
  /// Total acceleration, m/s^2. `field` is the value of field() at the body's position.
  SIM_HD Vector3<Real> acceleration(const Vector3<Real>& field, const Vector3<Real>& v) const {
    if (!with_drag) return field;
    using std::sqrt;
    return field - drag_decay(sqrt(v.dot(v)), Real(1)) * v;
  }
  /// Velocity loss by drag in `time` s at constant `speed`, divided by that speed.
  SIM_HD Real drag_decay(Real speed, Real time) const {
    return with_drag ? drag.decay(speed, radius, inverse_mass, time) : Real(0);
  }
  /// The velocity after `time` s of the acceleration a and of drag, second order in time. z = rate x time,
  /// with the drag rate at the midpoint as in drag.h. exp(-z), the remaining fraction of v, is approximated
  /// by its (0, 2) Pade approximant. Exact if Newtonian drag is the only force. As in drag.h, velocities
  /// never reverse, terminal speeds are exact, and any z is allowed.
  SIM_HD Vector3<Real> kick(const Vector3<Real>& v, const Vector3<Real>& a, Real time) const {
    if (!with_drag) return v + time * a;
    const Vector3<Real> without_drag = v + (time / 2) * a;
    using std::sqrt;
    const Real speed = sqrt(without_drag.dot(without_drag));
    if (!(speed > 0)) return v + time * a;
    const Real middle = (1 - drag.loss(speed, radius, inverse_mass, time / 2)) * speed;
    const Real z = drag_decay(middle, time);
    const Real whole = 1 + z + z * z / 2;
    // Two forms of the same expression. For small z, avoid differences of numbers near 1. For large z, avoid
    // that rounding reverses the velocity.
    if (z > 1) return v / whole + (1 + z / 2) / whole * time * a;
    return v + (1 + z / 2) / whole * (time * a - z * v);
  }
};

/// Result of one step of free motion, m/s.
template <class Real>
struct FreeStep {
  Vector3<Real> drift_velocity;  ///< mean velocity over the step
  Vector3<Real> velocity;        ///< velocity at the end
};

struct VelocityVerlet {
  static constexpr double first = 0.5, second = 0.5;  ///< fractions of h: the two kicks
};

/// One velocity Verlet step of h s from x and v; `a` is the field at x.
template <class Kicks = VelocityVerlet, class Real, class Forces>
SIM_HD FreeStep<Real> verlet_step(const Forces& forces, const Vector3<Real>& x, const Vector3<Real>& v,
                                  const Vector3<Real>& a, Real h) {
  const Vector3<Real> half = forces.kick(v, a, Real(Kicks::first) * h);
  return {half, forces.kick(half, forces.field(x + h * half), Real(Kicks::second) * h)};
}

struct RungeKutta4 {
  static constexpr int stages = 4;
  static constexpr double at(int stage) { return stage == 0 ? 0 : stage == 3 ? 1 : 0.5; }  ///< fraction of h
  static constexpr double weight(int stage) { return (stage == 0 || stage == 3 ? 1 : 2) / 6.0; }
};

/// One RK4 step; parameters as in verlet_step(). Each stage uses the velocity and force of the previous
/// stage.
template <class Tableau = RungeKutta4, class Real, class Forces>
SIM_HD FreeStep<Real> rk4_step(const Forces& forces, const Vector3<Real>& x, const Vector3<Real>& v,
                               const Vector3<Real>& a, Real h) {
  using std::sqrt;
  const Real max_speed = sqrt(v.dot(v)) + h * sqrt(a.dot(a));
  if (!(forces.drag_decay(max_speed, h) <= 1)) return verlet_step<VelocityVerlet>(forces, x, v, a, h);
  Vector3<Real> speed = v, force = forces.acceleration(a, v);
  // Sums of differences from v, so that v stays exact without forces.
  Vector3<Real> along = Vector3<Real>::Zero(), change = Real(Tableau::weight(0)) * force;
  for (int stage = 1; stage < Tableau::stages; ++stage) {
    const Real part = Real(Tableau::at(stage)) * h;
    const Vector3<Real> there = x + part * speed, gained = part * force;
    speed = v + gained;
    force = forces.acceleration(forces.field(there), speed);
    along += Real(Tableau::weight(stage)) * gained;
    change += Real(Tableau::weight(stage)) * force;
  }
  return {v + along, v + h * change};
}

}  // namespace collidoscope

#pragma once
// Integrators of free motion: of a body that in a substep meets nothing, and is moved only by forces that go
// smoothly with where it is and how fast: gravity, attractors, drag. Each answers with two velocities, the
// one along which the body goes for h, and the one that it has then; semi-implicit Euler, for which both are
// the same, needs none of this and is no part of it (move.h).
//
//   velocity_verlet  half a kick, drift, half a kick; second order, symplectic without drag (Hairer, Lubich,
//                    Wanner, "Geometric Numerical Integration", I.1.4)
//   rk4              the classical method; fourth order. Its steps are explicit, so a body that drag stops
//                    within a step or so goes by velocity_verlet, whose kicks are not
//
// Both fly a parabola exactly. Pure functions of values in SI units; without libm, as all that reaches the
// state. The coefficients are template arguments, so that a test can show what a wrong one does.

#include "sim_cuda/dynamics/attractor.h"
#include "sim_cuda/dynamics/drag.h"

namespace collidoscope {

/// What moves a free body.
template <class Real>
struct SmoothForces {
  AttractorView<Real> attractors;  ///< none where the effect is off
  DragLaw<Real> drag;
  bool with_drag;             ///< the effect drag is on
  Vector3<Real> gravity;      ///< m/s^2
  Real radius, inverse_mass;  ///< m, 1/kg: of the body

  /// m/s^2, all but drag.
  SIM_HD Vector3<Real> field(const Vector3<Real>& x) const {
    Vector3<Real> sum = gravity;
    for (int k = 0; k < attractors.count; ++k) sum += attractors.points[k].acceleration(x);
    return sum;
  }
  /// m/s^2, all of it; `field` is what field() says there.
  SIM_HD Vector3<Real> acceleration(const Vector3<Real>& field, const Vector3<Real>& v) const {
    if (!with_drag) return field;
    using std::sqrt;
    return field - drag_decay(sqrt(v.dot(v)), Real(1)) * v;
  }
  /// What drag would take of `speed` in `time` s if it stayed as it is, over that speed.
  SIM_HD Real drag_decay(Real speed, Real time) const {
    return with_drag ? drag.decay(speed, radius, inverse_mass, time) : Real(0);
  }
  /// v after `time` s of the acceleration a and of drag, to second order in time: with z = rate x time, the
  /// rate in the middle as drag.h has it, and Pade's (0, 2) for exp(-z), the part of v that is left. Exact
  /// where Newton's drag is all there is. As in drag.h, nothing is turned round, terminal speeds are exact,
  /// and no z is too large.
  SIM_HD Vector3<Real> kick(const Vector3<Real>& v, const Vector3<Real>& a, Real time) const {
    if (!with_drag) return v + time * a;
    const Vector3<Real> without_drag = v + (time / 2) * a;
    using std::sqrt;
    const Real speed = sqrt(without_drag.dot(without_drag));
    if (!(speed > 0)) return v + time * a;
    const Real middle = (1 - drag.loss(speed, radius, inverse_mass, time / 2)) * speed;
    const Real z = drag_decay(middle, time);
    const Real whole = 1 + z + z * z / 2;
    // The same twice: so that a little is taken without a difference of numbers near 1, and nearly all
    // without a rounding that takes more and turns the body round.
    if (z > 1) return v / whole + (1 + z / 2) / whole * time * a;
    return v + (1 + z / 2) / whole * (time * a - z * v);
  }
};

/// One step of free motion; m/s.
template <class Real>
struct FreeStep {
  Vector3<Real> drift_velocity;  ///< its mean velocity, over the step
  Vector3<Real> velocity;        ///< its velocity then
};

struct VelocityVerlet {
  static constexpr double first = 0.5, second = 0.5;  ///< of h: the two kicks
};

/// From x and v, where the field is `a`, for h s.
template <class Kicks = VelocityVerlet, class Real, class Forces>
SIM_HD FreeStep<Real> verlet_step(const Forces& forces, const Vector3<Real>& x, const Vector3<Real>& v,
                                  const Vector3<Real>& a, Real h) {
  const Vector3<Real> half = forces.kick(v, a, Real(Kicks::first) * h);
  return {half, forces.kick(half, forces.field(x + h * half), Real(Kicks::second) * h)};
}

struct RungeKutta4 {
  static constexpr int stages = 4;
  static constexpr double at(int stage) { return stage == 0 ? 0 : stage == 3 ? 1 : 0.5; }  ///< of h
  static constexpr double weight(int stage) { return (stage == 0 || stage == 3 ? 1 : 2) / 6.0; }
};

/// The same. Each stage lies along the speed and the force of the one before it.
template <class Tableau = RungeKutta4, class Real, class Forces>
SIM_HD FreeStep<Real> rk4_step(const Forces& forces, const Vector3<Real>& x, const Vector3<Real>& v,
                               const Vector3<Real>& a, Real h) {
  using std::sqrt;
  const Real max_speed = sqrt(v.dot(v)) + h * sqrt(a.dot(a));
  if (!(forces.drag_decay(max_speed, h) <= 1)) return verlet_step<VelocityVerlet>(forces, x, v, a, h);
  Vector3<Real> speed = v, force = forces.acceleration(a, v);
  // Sums of differences from v, so that what no force changes is exact.
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

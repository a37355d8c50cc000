#pragma once
// Drag force of a medium at rest on a sphere of radius r with velocity v:
//
//   F = -6 pi eta r v - 1/2 rho C pi r^2 |v| v
//
// The sum of Stokes drag (1851) for slow flow and Newtonian drag (Principia, II) for fast flow, the usual
// approximation in between. The effect is required if the medium has a viscosity eta (Pa s), or a density rho
// (kg/m^3) and a coefficient C; ranges in scene/limits.h. Drag does not affect spin and causes no lift.
//
// Integrated by implicit Euler. The force is parallel to v, so this is a quadratic equation for the new speed
// s'. s is the speed after h with all other forces:
//
//   s' (1 + A) + B s'^2 = s,  A = h 6 pi eta r/m,  B = h/2 rho C pi r^2/m
//
// Its root lies in [0, s] for every h. Drag therefore never reverses a velocity, and the terminal speed is
// exact. Drag also acts on motion that a contact stops afterwards, so a contact carries 1/(1 + A) of a
// weight; this is correct to first order.

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

template <class Real>
struct DragLaw {
  Real linear = 0;     ///< Pa s, 6 pi eta
  Real quadratic = 0;  ///< kg/m^3, pi/2 rho C

  static DragLaw of(const Drag& medium) {
    constexpr double pi = 3.141592653589793;
    return {static_cast<Real>(6 * pi * medium.viscosity),
            static_cast<Real>(pi / 2 * medium.density * medium.coefficient)};
  }

  /// The fraction, 0 to 1, of a speed of `speed` m/s > 0 that is lost in h seconds. Avoids differences of
  /// numbers near 1, because air removes about 1e-6 per substep. The limit of 1 prevents that rounding
  /// reverses the velocity.
  SIM_HD Real loss(Real speed, Real radius, Real inverse_mass, Real h) const {
    const Real a = bounded(linear, h * radius * inverse_mass);
    const Real b4 = 4 * bounded(quadratic, h * radius * radius * inverse_mass * speed);
    using std::sqrt;
    const Real root = sqrt((1 + a) * (1 + a) + b4);
    return min_of((a + (2 * a + a * a + b4) / (root + 1)) / (1 + a + root), Real(1));
  }

  /// The explicit rate of drag at `speed`, times h; 0 to 2e18.
  SIM_HD Real decay(Real speed, Real radius, Real inverse_mass, Real h) const {
    return bounded(linear, h * radius * inverse_mass) +
           bounded(quadratic, h * radius * radius * inverse_mass * speed);
  }

 private:
  /// The product, limited to 1e18, which acts as infinity. 0 for a coefficient of 0, even if the other factor
  /// is infinite.
  SIM_HD static Real bounded(Real coefficient, Real of) {
    return coefficient > 0 ? min_of(Real(1e18), coefficient * of) : Real(0);
  }
};

/// Subtracts from each velocity the loss by drag, computed for the speed after `gravity` and `field` have
/// acted in the substep.
template <class Real>
struct DragBodies {
  BodyView<Real> bodies;
  DragLaw<Real> law;
  Vector3<Real> gravity;       ///< m/s^2; zero if the effect is off
  const Vector3<Real>* field;  ///< m/s^2, by body; null without attractors
  Real h;                      ///< s
  const StepControl* control;

  SIM_HD void operator()(int body) const {
    if (control->overflow) return;
    bodies.velocity[body] = after_drag(body, bodies.velocity[body]);
  }
  SIM_HD Vector3<Real> after_drag(int body, const Vector3<Real>& v) const {
    Vector3<Real> next = v + h * gravity;
    if (field != nullptr) next += h * field[body];
    using std::sqrt;
    const Real speed = sqrt(next.dot(next));
    if (!(speed > 0)) return v;
    return v - law.loss(speed, bodies.radius[body], bodies.inverse_mass[body], h) * next;
  }
};

}  // namespace collidoscope

#pragma once
// Drag: what a medium at rest takes from a sphere of radius r that moves through it at v,
//
//   F = -6 pi eta r v - 1/2 rho C pi r^2 |v| v
//
// Stokes (1851) for slow, Newton (Principia, II) for fast flow, added as it is usual between the two. Called
// for by a medium of viscosity eta (Pa s) or density rho (kg/m^3) and coefficient C; ranges in limits.h. It
// does not slow spin, and does not lift.
//
// Implicit Euler, which for a force along v is a quadratic equation for the new speed s' where s is the speed
// that the other forces would lead to in h:
//
//   s' (1 + A) + B s'^2 = s,  A = h 6 pi eta r/m,  B = h/2 rho C pi r^2/m
//
// Its root lies in [0, s], for every h: no drag turns a body round, and the terminal speed is exact. What a
// contact then stops drag has slowed before, so the contact bears 1/(1 + A) of a weight: right to first
// order.

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

  /// The part of a speed of `speed` m/s > 0 that is lost in h seconds, 0 to 1. Without a difference of
  /// numbers near 1: air takes a millionth at a time. Where it takes nearly all, rounding may not take more:
  /// that would turn the body round.
  SIM_HD Real loss(Real speed, Real radius, Real inverse_mass, Real h) const {
    const Real a = bounded(linear, h * radius * inverse_mass);
    const Real b4 = 4 * bounded(quadratic, h * radius * radius * inverse_mass * speed);
    using std::sqrt;
    const Real root = sqrt((1 + a) * (1 + a) + b4);
    return min_of((a + (2 * a + a * a + b4) / (root + 1)) / (1 + a + root), Real(1));
  }

  /// The same if the speed stayed as it is: the rate of drag times h, from 0 to 2e18.
  SIM_HD Real decay(Real speed, Real radius, Real inverse_mass, Real h) const {
    return bounded(linear, h * radius * inverse_mass) +
           bounded(quadratic, h * radius * radius * inverse_mass * speed);
  }

 private:
  /// Of 1e18 and more, which is as good as infinite. A coefficient of 0 is 0, whatever the rest would make of
  /// it.
  SIM_HD static Real bounded(Real coefficient, Real of) {
    return coefficient > 0 ? min_of(Real(1e18), coefficient * of) : Real(0);
  }
};

/// Takes from each velocity what drag will have taken once `gravity` and `field` have acted in the substep.
template <class Real>
struct DragBodies {
  BodyView<Real> bodies;
  DragLaw<Real> law;
  Vector3<Real> gravity;       ///< m/s^2, zero where the effect is off
  const Vector3<Real>* field;  ///< m/s^2, by body; null without one
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

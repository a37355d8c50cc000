#pragma once
// How bodies move in a substep once the solver has spoken: by the scene's integrator and rotation update.
//
// Contacts and joints are impulses: where one acts, a velocity jumps, and no scheme of an order above the
// first knows what that means (Acary, Brogliato 2008, 10). So the two are split (Chen, Acary, Virlez, Bruls
// 2013): a body whose velocity at the end of the sweeps is bit for bit what smooth forces alone made of it
// was touched by nothing, and its step is that of dynamics/integrators.h, from where and how fast it was
// when the substep began; all others move as with semi_implicit_euler, bit for bit. Piles, joints and what
// rests are therefore the same under every integrator; between its bounces a ball flies to the order of its
// own.
//
// A step of higher order may not create a contact: one that would end deeper in a plane than Euler's way is
// Euler's. In other bodies and boxes a step may end deeper by |a| h^2 / 2, until the next substep; clamped
// bodies (continuous_collision.h) are clamped on their steps. Sleeping bodies have none, and those that no
// force moves are put back on their courses.
//
// Turning is free in every body, since torques come as impulses: dynamics/rotation_updates.h.
//
// Owned by a solver. With semi_implicit_euler and first_order it takes no memory, and launches what
// dynamics/move.h does and nothing else.

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/dynamics/continuous_collision.h"
#include "sim_cuda/solver/contact_solver.h"

namespace collidoscope {

template <class Real>
class FreeIntegrator {
 public:
  FreeIntegrator(Executor& executor, const SolverScene<Real>& scene);

  /// Before anything changes velocities in a substep; `impulse`: before anything but contacts does.
  void begin();
  /// After all that changes velocities before bodies move, for `h` s. `forces_applied`: gravity is in them.
  void integrate(Real h, bool forces_applied);
  /// The bodies, along whose velocities they now go.
  BodyView<Real> bodies_with_drift_velocity() const;
  /// Moves and turns who is awake for `h` s: along bodies_with_drift_velocity(), as far as `clamped` lets
  /// them. `forces_applied` as before.
  void move(Real h, bool forces_applied, const std::uint8_t* asleep = nullptr,
            const ClampedMotion<Real>& clamped = {});

 private:
  bool uses_higher_order() const { return scene_.integrator != Integrator::semi_implicit_euler; }

  Executor& executor_;
  const SolverScene<Real> scene_;
  Buffer<PackedVector3<Real>> before_;          ///< m/s, when the substep began
  Buffer<PackedVector3<Real>> drift_velocity_;  ///< m/s, what bodies_with_drift_velocity() has
};

}  // namespace collidoscope

#pragma once
// How bodies move in a substep once the solver has spoken: by the scene's integrator and rotation update.
//
// Contacts and joints are impulses: where one acts, a velocity jumps, and no scheme of an order above the
// first knows what that means (Acary, Brogliato 2008, 10). So the two are split (Chen, Acary, Virlez, Bruls
// 2013): a body whose velocity at the end of the sweeps is bit for bit what smooth forces alone made of it
// was touched by nothing, and its flight is that of dynamics/integrators.h, from where and how fast it was
// when the substep began; all others move as with semi_implicit_euler, bit for bit. Piles, joints and what
// rests are therefore the same under every integrator; between its bounces a ball flies to the order of its
// own.
//
// What no solver foresaw, no flight may bring: one that would end deeper in a plane than Euler's way is
// Euler's. In other bodies and boxes a flight may end deeper by |a| h^2 / 2, until the next substep; held
// bodies (continuous_collision.h) are held on their flights. Sleeping bodies have none, and those that no
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
class FreeMotion {
 public:
  FreeMotion(Executor& executor, const SolverScene<Real>& scene);

  /// Before anything changes velocities in a substep; `impulse`: before anything but contacts does.
  void begin();
  /// After all that changes velocities before bodies move, for `h` s. `forced`: gravity is in them.
  void fly(Real h, bool forced);
  /// The bodies, along whose velocities they now go.
  BodyView<Real> ways() const;
  /// Moves and turns who is awake for `h` s: along ways(), as far as `held` lets them. `forced` as before.
  void move(Real h, bool forced, const std::uint8_t* asleep = nullptr, const HeldMotion<Real>& held = {});

 private:
  bool flies() const { return scene_.integrator != Integrator::semi_implicit_euler; }

  Executor& executor_;
  const SolverScene<Real> scene_;
  Buffer<StoredVector3<Real>> before_;  ///< m/s, when the substep began
  Buffer<StoredVector3<Real>> along_;   ///< m/s, what ways() has
};

}  // namespace collidoscope

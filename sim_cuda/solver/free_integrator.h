#pragma once
// Position and orientation update of a substep after the solver has run, by the scene's integrator and
// rotation update.
//
// Contacts and joints act as impulses, which make velocities jump. Schemes of order above one are not valid
// across such jumps (Acary, Brogliato 2008, 10). So bodies are split into two sets (Chen, Acary, Virlez,
// Bruls 2013).
//
// Bodies of joint trees move as joint_tree_solver.h expects: along v - h g / 2 if their tree touches nothing,
// else along v. That solver rotates them.
//
// Free bodies: the velocity after the iterations equals, bit for bit, the velocity by smooth forces alone.
// They are integrated by dynamics/integrators.h from the state after the impacts of the substep (impact.h).
// So a body is free in the substep in which it bounces, too. All other bodies move as with
// semi_implicit_euler, bit for bit. So joints and resting bodies are the same under every integrator, and a
// ball between bounces moves with the order of its integrator. With `impulse`, contacts between bodies come
// before begin(). Walls come after it, and change the saved velocity of a body that bounces (walls.h).
//
// A higher-order step must not create a contact. If it would penetrate a plane deeper than the Euler step,
// the Euler step is used. Into other bodies and boxes, a step may penetrate deeper by |a| h^2 / 2 until the
// next substep. With continuous collision (continuous_collision.h), the higher-order step is clamped.
// Sleeping bodies do not move. Kinematic bodies are restored to their prescribed motion.
//
// Rotation is torque-free between impulses for all bodies. Bodies with equal moments of inertia rotate in the
// stages of dynamics/move.h. Only a scene with other bodies has the stage "turn"
// (dynamics/rotation_updates.h).
//
// Owned by a solver. With semi_implicit_euler and without continuous collision it uses no memory, and
// launches only the stages of dynamics/move.h and "turn", and "integrate" if the energy guard needs the
// velocities of the move. Joint trees need the drift velocity, too.

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/dynamics/continuous_collision.h"
#include "sim_cuda/solver/contact_solver.h"

namespace collidoscope {

template <class Real>
class FreeIntegrator {
 public:
  FreeIntegrator(Executor& executor, const SolverScene<Real>& scene);

  /// Saves velocities at the start of a substep. Call after impacts, and before any other stage changes
  /// velocities. The solver `impulse` calls it after its contact iterations.
  void begin();
  /// Saved velocities, m/s, by body; null if they are not used.
  PackedVector3<Real>* start_velocity() { return before_.size() > 0 ? before_.data() : nullptr; }
  /// Computes drift velocities and final velocities. Call after all velocity changes, before move(). `h`:
  /// substep, s. `forces_applied`: velocities already include gravity. `moved`: the final velocities are also
  /// written there. `is_free`: 1 for each free body is written there. `bounced_mask`: see SoftWalls. All may
  /// be null.
  void integrate(Real h, bool forces_applied, PackedVector3<Real>* moved = nullptr,
                 std::uint8_t* is_free = nullptr, const std::uint32_t* bounced_mask = nullptr);
  /// Bodies whose velocity is the drift velocity of this substep.
  BodyView<Real> bodies_with_drift_velocity() const;
  /// Moves and rotates awake bodies for `h` s along the drift velocity, limited by `clamped`.
  /// `forces_applied`: see integrate().
  void move(Real h, bool forces_applied, const std::uint8_t* asleep = nullptr,
            ClampedMotion<Real> clamped = {});
  /// Clears parts of angular velocities that are not part of the state (wide_spin.h). Call at the end of a
  /// step in which contacts or joints may have changed angular velocities.
  void end_step();

 private:
  /// True if the drift velocity may differ from the final velocity. With continuous collision, the ways of
  /// fast bodies end at planes.
  bool has_drift_velocity() const {
    return scene_.integrator != Integrator::semi_implicit_euler || scene_.effects.continuous_collision ||
           members() != nullptr;
  }

  const TreeMember* members() const { return scene_.joints != nullptr ? scene_.joints->members() : nullptr; }

  Executor& executor_;
  const SolverScene<Real> scene_;
  Buffer<PackedVector3<Real>> before_;          ///< velocity at the start of the substep, m/s
  Buffer<PackedVector3<Real>> drift_velocity_;  ///< m/s, see bodies_with_drift_velocity()
};

}  // namespace collidoscope

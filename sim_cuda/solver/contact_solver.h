#pragma once
// Common interface of the solvers: from the contacts of a scene to its next state. The pipeline owns bodies
// and contacts, and finds the contacts anew before each run. A solver owns its lists and its warm-start
// data. Lives as long as the pipeline.

#include <memory>
#include <optional>
#include <vector>

#include "sim_cuda/core/hashed_arrays.h"
#include "sim_cuda/core/host_backup.h"
#include "sim_cuda/dynamics/attractor.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/dynamics/drag.h"
#include "sim_cuda/dynamics/kinematic_motion.h"
#include "sim_cuda/narrow_phase/contact_list.h"
#include "sim_cuda/scene/scene.h"
#include "sim_cuda/solver/box_surface.h"
#include "sim_cuda/solver/friction.h"
#include "sim_cuda/solver/joints.h"
#include "sim_cuda/solver/residual.h"
#include "sim_cuda/solver/restitution.h"
#include "sim_cuda/solver/rolling_resistance.h"
#include "sim_cuda/solver/sleeping.h"
#include "sim_cuda/solver/walls.h"
#include "sim_cuda/solver/warm_start.h"

namespace collidoscope {

/// Input of every solver. Pointers are in the executor's memory and stay valid for the solver's lifetime.
template <class Real>
struct SolverScene {
  BodyView<Real> bodies;
  std::int64_t body_count;
  KinematicView kinematic;
  Restitution<Real> restitution;
  Friction<Real> friction;   ///< unused if the effect is off
  RollingLaw<Real> rolling;  ///< unused if the effect is off
  const WallPlane<Real>* planes;
  int plane_count;
  BoxView<Real> boxes;
  StaticImpulse* static_impulses;  ///< by body; null without planes, boxes, gravity and attractors
  Vector3<Real> gravity;           ///< m/s^2, zero if the effect is off
  DragLaw<Real> drag;              ///< unused if the effect is off
  AttractorView<Real> attractors;
  Vector3<Real>* field;  ///< acceleration by attractors, m/s^2, by body; null if the effect is off
  Effects effects;
  std::optional<Box> box;
  Real time_step;            ///< s
  Real acceleration_margin;  ///< largest displacement in a step by gravity and attractors, m
  int substeps;              ///< >= 1
  int iterations;            ///< iterations over all contacts per solve, >= 1
  Integrator integrator;
  RotationUpdate rotation_update;        ///< unused without unequal moments
  bool unequal_moments;                  ///< a body rotates, and its moments of inertia are not all equal
  Vector3<float>* angular_velocity_low;  ///< rad/s (wide_spin.h); null in double, or without unequal moments
  Sleep sleep;                           ///< unused if the effect is off
  StepControl* control;

  /// Number of static surfaces: planes, then boxes.
  int surfaces() const { return plane_count + boxes.count; }
  /// True if contacts keep overlap (Softness), chain contacts have more passes (chain_passes.h), and the
  /// energy guard reduces loads (energy_guard.h).
  bool limits_recovery() const { return effects.gravity || effects.attractor; }
  Joints<Real>* joints;  ///< null if the effect is off
};

template <class Real>
class ContactSolver {
 public:
  virtual ~ContactSolver() = default;

  /// Pipeline runs per step. Each run finds its own contacts.
  virtual int runs_per_step() const = 0;
  /// Time span that the contacts of a run must cover, s; 0: contacts at the current positions only.
  virtual Real prediction_time() const = 0;
  /// Sets the capacity in contacts. Call outside of runs. Keeps the warm-start data.
  virtual void reserve(std::int64_t contact_capacity) = 0;
  /// Enqueues all stages that change velocities and poses in one run. `impulses`: output, impulse per
  /// contact, N s; may be null.
  virtual void advance(const ContactView<Real>& contacts, Real* impulses) = 0;

  /// Enables a residual measurement after each iteration (residual.h). Call outside of runs; runs must be
  /// recorded again afterwards. Off by default. No cost when off, and no effect on the state.
  virtual void record_residuals(bool on) = 0;
  /// Residuals of the last step, in iteration order. Waits for the device. Empty if recording is off.
  virtual std::vector<Residual> residuals() const = 0;

  /// Sleep state; null without the effect sleeping.
  virtual const Sleeping<Real>* sleeping() const { return nullptr; }

  /// Copies the warm-start data to the host; waits for the device. None for a solver without warm starting.
  virtual void save_warm_start(WarmStartParts&) const {}
  /// Loads the warm-start data of another solver of a scene with these bodies. Contact impulses are always
  /// used; plane impulses only if the number of planes agrees. Call outside of runs; runs must be recorded
  /// again afterwards.
  virtual void load_warm_start(const WarmStart&) {}
  /// Visits the arrays behind save_warm_start(), to copy them. Waits for the device.
  virtual void visit_warm_start(const ArrayVisitor&) {}
  /// Lists the numbers of save_warm_start(), to hash them. Unlike the arrays above, they depend on the state
  /// only, not on the way to it.
  virtual void list_warm_start(HashedArrays&) const {}
};

template <class Real>
std::unique_ptr<ContactSolver<Real>> make_contact_solver(Solver solver, Executor& executor,
                                                         const SolverScene<Real>& scene);

}  // namespace collidoscope

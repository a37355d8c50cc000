#pragma once
// What takes a scene from its contacts to its next state: one interface for all solvers. The pipeline owns
// bodies and contacts and finds the latter anew before each run; a solver owns its lists and what it
// remembers from step to step. Lives as long as the pipeline.

#include <memory>
#include <optional>
#include <vector>

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

/// What every solver works on. Pointers are in the executor's memory and stay for as long as the solver
/// lives.
template <class Real>
struct SolverScene {
  BodyView<Real> bodies;
  std::int64_t body_count;
  KinematicView kinematic;
  Restitution<Real> restitution;
  Friction<Real> friction;   ///< of no meaning where the effect is off
  RollingLaw<Real> rolling;  ///< of no meaning where the effect is off
  const WallPlane<Real>* planes;
  int plane_count;
  BoxView<Real> boxes;
  StaticImpulse* static_impulses;  ///< null where there are no planes or boxes
  Vector3<Real> gravity;           ///< m/s^2, zero where the effect is off
  DragLaw<Real> drag;              ///< of no meaning where the effect is off
  AttractorView<Real> attractors;
  Vector3<Real>* field;  ///< m/s^2, of the attractors, by body; null where the effect is off
  Effects effects;
  std::optional<Box> box;
  Real time_step;            ///< s
  Real acceleration_margin;  ///< m, by which a body goes aside in a step at most, for gravity and attractors
  int substeps;              ///< >= 1
  int iterations;            ///< sweeps over all contacts, >= 1
  Integrator integrator;
  RotationUpdate rotation_update;  ///< of no meaning where the effect rotation is off
  Sleep sleep;                     ///< of no meaning where the effect is off
  StepControl* control;

  /// What each body rests on by itself: planes, then boxes.
  int surfaces() const { return plane_count + boxes.count; }
  Joints<Real>* joints;  ///< null where the effect is off
};

template <class Real>
class ContactSolver {
 public:
  virtual ~ContactSolver() = default;

  /// Runs of the pipeline, each with contacts of its own, that make one step.
  virtual int runs_per_step() const = 0;
  /// s of motion that the contacts of a run must cover; 0: they are those of the bodies where they are.
  virtual Real prediction_time() const = 0;
  /// Outside of runs. `contact_capacity` in contacts; what is remembered stays.
  virtual void reserve(std::int64_t contact_capacity) = 0;
  /// Enqueues all that changes velocities and poses in one run. `impulses`, unless null: receives what each
  /// contact gave, N s.
  virtual void advance(const ContactView<Real>& contacts, Real* impulses) = 0;

  /// Outside of runs, which must be recorded again afterwards: whether each sweep is followed by a measure of
  /// what it left (residual.h). Off at first, and then it costs nothing; never changes the state.
  virtual void record_residuals(bool on) = 0;
  /// Of the last step, in the order of sweeps; waits for the device. Empty where they were not recorded.
  virtual std::vector<Residual> residuals() const = 0;

  /// Who sleeps; null where nothing can.
  virtual const Sleeping<Real>* sleeping() const { return nullptr; }

  /// What it knows from the runs before; waits for the device. Nothing, where it does not remember.
  virtual WarmStart save_warm_start() const { return {}; }
  /// Outside of runs, which must be recorded again afterwards. Takes over what another solver of a scene with
  /// these bodies knew: of contacts, all; of planes, if they are as many.
  virtual void load_warm_start(const WarmStart&) {}
  /// On the CPU: the arrays that save_warm_start() is made of, as runs write them.
  virtual void visit_warm_start(const ArrayVisitor&) {}
};

template <class Real>
std::unique_ptr<ContactSolver<Real>> make_contact_solver(Solver solver, Executor& executor,
                                                         const SolverScene<Real>& scene);

}  // namespace collidoscope

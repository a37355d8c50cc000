#pragma once
// The solver `soft_step` (Macklin et al. 2019: substeps beat iterations; Catto, "Solver2D", 2024). Contacts
// are found once per step, including all that its motion may bring together. Then K substeps follow,
//
//   impacts (impact.h) -> begin (forces, warm starting) -> solve -> move -> relax -> energy guard
//
// Only impacts have restitution; all later stages are inelastic. Impulses are warm-started: within a step per
// contact, from step to step by body ids. Impulses of impacts are not. Iterations process contacts colour by
// colour, then the mass-split set. Planes come first, and once more before bodies move, so no body enters a
// plane.
//
// Warm-start data change only in a committed run. After an overflow there are no contacts, and every stage
// over bodies checks control->overflow.

#include <cstdint>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/dynamics/continuous_collision.h"
#include "sim_cuda/solver/chain_contacts.h"
#include "sim_cuda/solver/colouring.h"
#include "sim_cuda/solver/contact_cache.h"
#include "sim_cuda/solver/contact_impulses.h"
#include "sim_cuda/solver/contact_solver.h"
#include "sim_cuda/solver/contact_storage.h"
#include "sim_cuda/solver/contacts_by_body.h"
#include "sim_cuda/solver/energy_guard.h"
#include "sim_cuda/solver/free_integrator.h"
#include "sim_cuda/solver/friction_constraint.h"
#include "sim_cuda/solver/impact_stage.h"
#include "sim_cuda/solver/plane_contacts.h"
#include "sim_cuda/solver/residuals.h"
#include "sim_cuda/solver/sleeping.h"
#include "sim_cuda/solver/soft_contact.h"
#include "sim_cuda/solver/soft_iteration.h"
#include "sim_cuda/solver/soft_walls.h"

namespace collidoscope {

template <class Real>
class SoftStepSolver final : public ContactSolver<Real> {
 public:
  /// Passes over all contacts in an iteration of `jacobi_split`. A pass has one round instead of about
  /// twenty, and converges more slowly.
  static constexpr int mass_split_passes = 4;
  /// Times as many passes in scenes with gravity or attractors and without friction. Such piles keep moving,
  /// so they sink and are lifted again more often: with one pass, the energy that this adds exceeds 1 % in
  /// ten times as many scenes.
  static constexpr int frictionless_passes = 2;

  /// `coloured` false: the solver `jacobi_split`. Its iterations have all contacts in the mass-split set.
  SoftStepSolver(Executor& executor, const SolverScene<Real>& scene, bool coloured);
  int runs_per_step() const override { return 1; }
  Real prediction_time() const override { return scene_.time_step; }
  void reserve(std::int64_t contact_capacity) override;
  /// Runs `iterations` iterations in each solve and each relax. `impulses`: sum over all substeps, impacts
  /// included.
  void advance(const ContactView<Real>& contacts, Real* impulses) override;
  void record_residuals(bool on) override;
  std::vector<Residual> residuals() const override;
  const Sleeping<Real>* sleeping() const override { return scene_.effects.sleeping ? &sleeping_ : nullptr; }
  void save_warm_start(WarmStartParts& parts) const override;
  void load_warm_start(const WarmStart& warm_start) override;
  void visit_warm_start(const ArrayVisitor& visit) override;
  void list_warm_start(HashedArrays& arrays) const override;

 private:
  // Phases of a step, in order. The energy guard (energy_guard.h) follows each relax.
  template <bool with_friction>
  void advance(const ContactView<Real>& contacts, Real* impulses);
  void begin_step(const ContactView<Real>& contacts);
  template <bool with_friction>
  void begin_substep();
  template <bool with_friction>
  void solve(int substep);
  void move();
  template <bool with_friction>
  void relax(int substep);
  void end_step(const ContactView<Real>& contacts, Real* impulses);

  // Parts of the phases.
  void prepare(const ContactView<Real>& contacts);
  template <bool with_friction>
  void apply_forces();
  template <class Act>
  void iterate(const char* stage, const Act& act);
  template <bool with_friction, class Act>
  void iterate_chains(const char* stage, const Act& act, WallPass pass);
  template <bool with_friction, class Launch>
  void dispatch_walls(const Launch& launch);
  /// Calls `launch` with true if the scene has friction and unequal moments of inertia.
  template <bool with_friction, class Launch>
  void with_moments(const Launch& launch) const {
    if constexpr (with_friction)
      if (scene_.unequal_moments) return launch.template operator()<true>();
    launch.template operator()<false>();
  }
  template <bool with_friction>
  void iterate_walls(const char* stage, WallPass pass);
  template <bool with_friction>
  void record_iteration(int substep, bool soft, int iteration);
  /// Runs a stage over awake bodies.
  template <class Stage>
  void run_bodies(const char* name, const Stage& stage);
  /// `coloured` false: all contacts are in the mass-split set.
  template <bool with_friction>
  OrderedContacts<Real, with_friction> ordered_contacts(bool coloured) const;
  RollingSource<Real> rolling_source() const;
  ItemCount contact_count() const { return ItemCount(&scene_.control->contacts, contact_capacity_); }

  Executor& executor_;
  const SolverScene<Real> scene_;
  const Real h_;       ///< substep, s
  const bool slides_;  ///< with gravity or attractors, without friction
  const int passes_;   ///< over all contacts per iteration
  const Softness<Real> softness_;
  std::int64_t contact_capacity_ = 0;
  Colouring colouring_;
  const bool coloured_;
  ContactDegrees uncoloured_degrees_, mass_split_degrees_;
  ChainContacts chains_;       ///< empty unless SolverScene::limits_recovery()
  ContactsByBody all_;         ///< all contacts
  ContactsByBody uncoloured_;  ///< contacts without a colour
  ContactsByBody split_;       ///< `jacobi_split`: the mass-split set of the iterations, all awake contacts
  Buffer<std::uint32_t> split_begin_, split_count_;  ///< as ColourView::begin and count, without colours
  Buffer<Pair> ordered_contacts_;                    ///< contacts in solve order; so are all buffers by place
  Buffer<std::uint32_t> place_of_;                   ///< by contact number
  Buffer<ContactBodies<Real>> bodies_of_;
  Buffer<DependencyCounters> dependency_counters_;
  Buffer<StepBody<Real>> step_bodies_;        ///< by body
  Buffer<BodyFriction<Real>> body_friction_;  ///< by body; empty without friction
  Buffer<PackedContact<Real>> soft_;
  Buffer<ContactSums<Real>> sums_;
  Buffer<FrictionSums<Real>> friction_sums_;  ///< empty without friction
  Buffer<ContactInertia<Real>> contact_inertia_;
  Buffer<Real> uncoloured_change_;             ///< N s
  Buffer<Vector3<Real>> uncoloured_friction_;  ///< N s
  ImpactStage<Real> impacts_;
  PlaneContacts<Real> planes_;
  RollingResistance<Real> rolling_;
  KinematicMotion<Real> kinematic_;
  FreeIntegrator<Real> free_integrator_;
  EnergyGuard<Real> energy_guard_;
  ContinuousCollision<Real> continuous_;
  Sleeping<Real> sleeping_;
  Residuals residuals_;
  ContactCache<Real> cache_;
};

}  // namespace collidoscope

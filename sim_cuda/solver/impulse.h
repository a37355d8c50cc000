#pragma once
// The solver `impulse`: immediate resolution as in the paper ("directly resolve the collision by modifying
// the dynamics attribute for each colliding object pair"), independent of processing order. Order: contacts
// colour by colour, the mass-split set, walls.
//
// Energy: at fixed positions, no stage raises the kinetic energy if restitution <= 1. Each impulse
// separates with at most the approach speed, and a split body is an average of such results. Free motion
// under gravity then keeps the energy with velocity_verlet and rk4. semi_implicit_euler removes
// 1/2 m g^2 h^2 from each body. Only the positional push against walls and bodies that are not dynamic can
// add energy, which is measured as `push_work`. Pushes between dynamic bodies keep the centre of mass, and
// with it the potential energy.

#include <cstdint>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/solver/colouring.h"
#include "sim_cuda/solver/contact_impulses.h"
#include "sim_cuda/solver/contact_solver.h"
#include "sim_cuda/solver/contacts_by_body.h"
#include "sim_cuda/solver/free_integrator.h"
#include "sim_cuda/solver/residuals.h"

namespace collidoscope {

/// Position correction of two overlapping spheres: a fraction of the depth beyond the slop, with an upper
/// limit. Lengths scale with the smaller sphere, so the behaviour is independent of size.
template <class Real>
struct PositionCorrection {
  static constexpr double fraction =
      0.2;  ///< of the depth beyond the slop, per step (usual Baumgarte range: 0.1 to 0.3)
  static constexpr double slop = 0.01;  ///< depth without correction, in radii of the smaller sphere
  static constexpr double limit = 0.2;  ///< largest correction per step, in radii of the smaller sphere
  /// Correction distance, m, >= 0. `depth` > 0 in m; `radius` of the smaller sphere in m.
  SIM_HD static Real distance(Real depth, Real radius) {
    return clamp_to(Real(fraction) * (depth - Real(slop) * radius), Real(0), Real(limit) * radius);
  }
};

template <class Real>
class ImpulseSolver final : public ContactSolver<Real> {
 public:
  ImpulseSolver(Executor& executor, const SolverScene<Real>& scene);
  int runs_per_step() const override { return scene_.substeps; }
  Real prediction_time() const override { return 0; }
  void reserve(std::int64_t contact_capacity) override;
  /// Runs `iterations` iterations over all colours. Positions are corrected in the last one.
  void advance(const ContactView<Real>& contacts, Real* impulses) override;
  /// Residuals cover contacts between bodies only; walls are resolved after the iterations.
  void record_residuals(bool on) override { residuals_.enable(on, scene_.substeps, scene_.iterations + 1); }
  std::vector<Residual> residuals() const override;

 private:
  /// `correct_positions`: also pushes overlapping bodies apart.
  void iterate(const ContactView<Real>& contacts, const ImpulseSum<Real>& impulses, bool correct_positions);
  void record_iteration(const ContactView<Real>& contacts, int iteration);

  Executor& executor_;
  const SolverScene<Real> scene_;
  const Real h_;  ///< length of a run, s
  std::int64_t contact_capacity_ = 0;
  Colouring colouring_;
  ContactDegrees uncoloured_degrees_;  ///< of the mass-split set
  ContactsByBody uncoloured_;
  Buffer<Real> uncoloured_impulse_;     ///< per contact, N s
  Buffer<Real> uncoloured_correction_;  ///< per contact, kg m
  KinematicMotion<Real> kinematic_;
  FreeIntegrator<Real> free_integrator_;
  Residuals residuals_;
};

}  // namespace collidoscope

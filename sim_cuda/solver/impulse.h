#pragma once
// The solver `impulse`: the paper's immediate resolution ("directly resolve the collision by modifying the
// dynamics attribute for each colliding object pair"), made independent of order: colour by colour, then what
// the colours left over by mass splitting, then the walls.
//
// Energy: at fixed positions no stage raises the kinetic energy where restitution <= 1 (each impulse
// separates, with at most the speed of approach; a split body is an average of such). Forwarding by
// semi-implicit Euler then takes 1/2 m g^2 h^2 from each free body (its drift in the ballistic energy). What
// can add energy is the positional push, against walls only: pushes between bodies keep the centre of mass,
// and with it the potential energy. That part is measured (`push_work`).

#include <cstdint>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/solver/colouring.h"
#include "sim_cuda/solver/contact_impulses.h"
#include "sim_cuda/solver/contact_solver.h"
#include "sim_cuda/solver/contacts_by_body.h"
#include "sim_cuda/solver/free_integrator.h"
#include "sim_cuda/solver/residuals.h"

namespace collidoscope {

/// The positional push of two overlapping spheres: a fraction of what exceeds the slop, bounded. Lengths
/// scale with the smaller sphere, so that dust and boulders behave alike.
template <class Real>
struct PositionCorrection {
  static constexpr double fraction =
      0.2;  ///< of the excess depth, per step (Baumgarte's usual range is 0.1 to 0.3)
  static constexpr double slop = 0.01;  ///< depth left alone, in radii of the smaller sphere
  static constexpr double limit = 0.2;  ///< largest correction per step, in radii of the smaller sphere
  /// `depth` > 0 in m, `radius` of the smaller sphere in m; returns m, >= 0.
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
  /// `iterations` sweeps over all colours; the push is made in the last.
  void advance(const ContactView<Real>& contacts, Real* impulses) override;
  /// Of bodies alone: walls come after the sweeps.
  void record_residuals(bool on) override { residuals_.enable(on, scene_.substeps, scene_.iterations + 1); }
  std::vector<Residual> residuals() const override;

 private:
  /// `correct_positions`: overlaps apart, too.
  void iterate(const ContactView<Real>& contacts, const ImpulseSum<Real>& impulses, bool correct_positions);
  void record_iteration(const ContactView<Real>& contacts, int iteration);

  Executor& executor_;
  const SolverScene<Real> scene_;
  const Real h_;  ///< s, of a run
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

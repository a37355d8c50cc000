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
#include "sim_cuda/narrow_phase/contact_list.h"
#include "sim_cuda/solver/colouring.h"
#include "sim_cuda/solver/contact_impulses.h"
#include "sim_cuda/solver/restitution.h"

namespace collidoscope {

/// What the solver reads and writes of the bodies, by id.
template <class Real>
struct SolverBodies {
  Vector3<Real>* position;   ///< m; moved by the push alone
  Vector3<Real>* velocity;   ///< m/s
  const Real* inverse_mass;  ///< 1/kg
  const Real* radius;        ///< m
};

/// The positional push of two overlapping spheres: a fraction of what exceeds the slop, bounded. Lengths
/// scale with the smaller sphere, so that dust and boulders behave alike.
template <class Real>
struct PushRule {
  static constexpr double fraction =
      0.2;  ///< of the excess depth, per step (Baumgarte's usual range is 0.1 to 0.3)
  static constexpr double slop = 0.01;  ///< depth left alone, in radii of the smaller sphere
  static constexpr double limit = 0.2;  ///< largest correction per step, in radii of the smaller sphere
  /// `depth` > 0 in m, `radius` of the smaller sphere in m; returns m, >= 0.
  SIM_HD static Real correction(Real depth, Real radius) {
    return clamp_to(Real(fraction) * (depth - Real(slop) * radius), Real(0), Real(limit) * radius);
  }
};

template <class Real>
class ImpulseSolver {
 public:
  explicit ImpulseSolver(Executor& executor);
  void reserve(std::int64_t bodies, std::int64_t contact_capacity);
  /// Changes velocities, and positions by the push. `iterations` sweeps over all colours; the push is made in
  /// the last. `impulses`, unless null: receives what each contact gave over all sweeps, N s.
  void solve(const ContactView<Real>& contacts, const SolverBodies<Real>& bodies,
             const Restitution<Real>& restitution, int iterations, Real* impulses, StepControl* control);

 private:
  void list_split(const ContactView<Real>& contacts, StepControl* control);
  template <bool push, bool record>
  void sweep(const ContactView<Real>& contacts, const SolverBodies<Real>& bodies,
             const Restitution<Real>& restitution, const ImpulseSum<Real, record>& impulses,
             const StepControl* control);

  Executor& executor_;
  Colouring colouring_;
  std::int64_t bodies_ = 0, contact_capacity_ = 0;
  // The mass-split set: for each body, the list of its contacts in it.
  Buffer<std::uint32_t> split_items_;   ///< {bodies or 0, entries handed out}
  Buffer<std::uint32_t> split_count_;   ///< per body
  Buffer<std::uint32_t> split_filled_;  ///< per body
  Buffer<std::uint32_t> split_begin_;   ///< per body
  Buffer<std::uint32_t> split_entry_;   ///< contact numbers
  Buffer<Real> split_impulse_;          ///< per contact, N s
  Buffer<Real> split_push_;             ///< per contact, kg m
};

}  // namespace collidoscope

#pragma once
// What `soft_step` keeps of planes and box obstacles: one entry for each surface and body. SoftWalls is the
// view of it that stages take.

#include <cstdint>

#include "sim_cuda/core/aside.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/solver/contact_solver.h"
#include "sim_cuda/solver/soft_walls.h"
#include "sim_cuda/solver/solver_memory.h"

namespace collidoscope {

template <class Real>
class PlaneContacts {
 public:
  PlaneContacts(Executor& executor, const SolverScene<Real>& scene);

  /// `inverse_h`: 1/s, of a substep.
  template <bool rubbed, bool boxed>
  SoftWalls<Real, rubbed, boxed> view(Real inverse_h) const {
    return {scene_.bodies,
            scene_.body_count,
            scene_.planes,
            scene_.plane_count,
            scene_.restitution,
            scene_.gravity,
            inverse_h,
            impulse_.data(),
            bounce_.data(),
            at_.data(),
            WallGrips<Real>{scene_.friction, friction_.data(), friction_total_.data(), pressed_.data()},
            BoxContacts<Real>{scene_.boxes, box_face_.data(), box_touched_.data()},
            scene_.ledger};
  }
  const Real* impulse() const { return impulse_.data(); }  ///< N s, as SoftWalls::impulse

  void save(SolverMemory& memory) const;
  /// Of a scene with other surfaces: nothing is loaded.
  void load(const SolverMemory& memory);
  void visit(const ArrayVisit& visit) const;

 private:
  void ask_all();

  const SolverScene<Real> scene_;
  Buffer<Real> impulse_, bounce_;                    ///< surfaces x bodies; empty without surfaces
  Buffer<std::uint32_t> at_;                         ///< surfaces of a body, as bits; empty without surfaces
  Buffer<Vector3<Real>> friction_, friction_total_;  ///< surfaces x bodies; empty without friction
  Buffer<Real> pressed_;                             ///< as friction_
  Buffer<Face<Real>> box_face_;                      ///< boxes x bodies; empty without boxes
  Buffer<Vector3<Real>> box_touched_;
};

}  // namespace collidoscope

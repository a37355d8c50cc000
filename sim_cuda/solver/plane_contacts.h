#pragma once
// Persistent contact state of `soft_step` at planes and box obstacles: one entry per surface and body.
// Owned by the solver. SoftWalls is the view for stages.

#include <cstdint>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/hashed_arrays.h"
#include "sim_cuda/core/host_backup.h"
#include "sim_cuda/solver/contact_solver.h"
#include "sim_cuda/solver/soft_contact.h"
#include "sim_cuda/solver/soft_walls.h"
#include "sim_cuda/solver/warm_start.h"

namespace collidoscope {

template <class Real>
class PlaneContacts {
 public:
  PlaneContacts(Executor& executor, const SolverScene<Real>& scene);

  /// `inverse_h`: 1 / substep, 1/s.
  template <bool with_friction, bool with_box_obstacles>
  SoftWalls<Real, with_friction, with_box_obstacles> view(Real inverse_h) const {
    return {scene_.bodies,
            scene_.body_count,
            scene_.planes,
            scene_.plane_count,
            scene_.gravity,
            inverse_h,
            closing_gap(scene_.acceleration_margin, scene_.substeps) * inverse_h,
            impulse_.data(),
            bounced_mask_.data(),
            stopped_.data(),
            active_mask_.data(),
            WallFriction<Real>{scene_.friction, friction_.data()},
            BoxContacts<Real>{scene_.boxes, box_planes_.data()},
            scene_.static_impulses,
            ClearSpace<Real>::of(scene_.box, scene_.plane_count, 1 / inverse_h)};
  }
  Real* impulse() const { return impulse_.data(); }  ///< N s, see SoftWalls::impulse
  const std::uint32_t* bounced_mask() const {
    return bounced_mask_.size() > 0 ? bounced_mask_.data() : nullptr;
  }
  const std::uint8_t* stopped() const {
    return stopped_.size() > 0 ? stopped_.data() : nullptr;
  }  ///< see SoftWalls
  const ContactPlane<Real>* box_planes() const { return box_planes_.data(); }
  Vector3<Real>* friction() const { return friction_.size() > 0 ? friction_.data() : nullptr; }  ///< N s

  void save(WarmStartParts& parts) const;
  /// Loads nothing if the number of surfaces differs.
  void load(const WarmStart& warm_start);
  void visit(const ArrayVisitor& visit) const;
  void list(HashedArrays& arrays) const;

 private:
  void activate_all();

  const SolverScene<Real> scene_;
  Buffer<Real> impulse_;  ///< surfaces x bodies; empty without surfaces
  Buffer<std::uint32_t> bounced_mask_,
      active_mask_;                        ///< by body, one bit per surface; empty without surfaces
  Buffer<std::uint8_t> stopped_;           ///< by body; empty without surfaces
  Buffer<Vector3<Real>> friction_;         ///< surfaces x bodies; empty without friction
  Buffer<ContactPlane<Real>> box_planes_;  ///< boxes x bodies; empty without boxes
};

}  // namespace collidoscope

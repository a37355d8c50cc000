#pragma once
// Simulation buffers of one world: bodies, materials, planes, boxes and attractors, initialized from the
// scene. Owned by the pipeline. Contains no stages.

#include <cstdint>
#include <optional>
#include <vector>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/dynamics/attractor.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/narrow_phase/contact_list.h"
#include "sim_cuda/run/body_states.h"
#include "sim_cuda/scene/initial_bodies.h"
#include "sim_cuda/scene/scene.h"
#include "sim_cuda/solver/contact_solver.h"
#include "sim_cuda/solver/walls.h"

namespace collidoscope {

/// How bodies move in a step, for speculative contacts.
MotionBound motion_bound(const Effects& effects);
/// Over all materials, 0 to 1.
double max_restitution(const Scene& scene);

template <class Real>
class SimulationState {
 public:
  SimulationState(Executor& executor, const Scene& scene, const InitialBodies& initial,
                  const Effects& effects, int substeps);

  std::int64_t body_count() const { return body_count_; }
  const BodyBuffers<Real>& bodies() const { return bodies_; }
  BodyView<Real> view() const { return bodies_.view(); }
  StaticImpulse* static_impulses() const { return bodies_.static_impulses.data(); }
  const std::uint32_t* meshes() const { return mesh_.data(); }  ///< by body, 0: sphere; null: all are spheres
  const std::optional<Box>& box() const { return box_; }
  const Vector3<Real>& gravity() const { return gravity_; }  ///< m/s^2, zero if the effect is off
  const Vector3<Real>* field() const {
    return field_.data();
  }  ///< acceleration by attractors, m/s^2, by body; or null
  const WallPlane<Real>* planes() const { return planes_.data(); }
  int plane_count() const { return static_cast<int>(planes_.size()); }
  BoxView<Real> boxes() const { return {box_surfaces_.data(), static_cast<int>(box_surfaces_.size())}; }
  AttractorView<Real> attractors() const {
    return {attractors_.data(), static_cast<int>(attractors_.size())};
  }
  SphereView<Real> spheres() const {
    return {bodies_.position.data(), bodies_.radius.data(),
            kinematic_.size() > 0 ? bodies_.inverse_mass.data() : nullptr};
  }
  /// How far to predict contacts for the next `time` s; not at all if it is 0.
  SpeculativeMargin<Real> speculative_margin_in(Real time) const;
  /// Input of a solver. `joints`: null if the effect is off.
  SolverScene<Real> solver_scene(const Scene& scene, int substeps, StepControl* control,
                                 Joints<Real>* joints) const;

  // Copies from and to the host; call outside of runs.
  void download(DeferredParts<BodyStates>& parts) const;
  /// Overwrites bodies 0 to states.position.size() - 1. Also sets their static impulses if both worlds have
  /// walls.
  void upload(const BodyStates& states, const std::vector<StaticImpulse>& static_impulses);

 private:
  /// Upper bound on the relative displacement of two bodies in `time` s by gravity and attractors, m.
  Real acceleration_margin_in(Real time) const;
  void upload_bodies(const InitialBodies& initial);
  void upload_rotation(const InitialBodies& initial);
  void upload_materials(const Scene& scene, const InitialBodies& initial, int substeps);
  void upload_surfaces(const Scene& scene);
  void upload_attractors(const Scene& scene);

  Executor& executor_;
  const std::int64_t body_count_;
  const Effects effects_;
  const std::optional<Box> box_;
  const Vector3<Real> gravity_;              // m/s^2, zero if the effect is off
  Buffer<PointAttractor<Real>> attractors_;  // empty if the effect is off
  Buffer<Vector3<Real>> field_;  // acceleration by attractors, by body, m/s^2; empty if the effect is off
  Real max_field_ = 0;           // upper bound over all attractors together, m/s^2
  BodyBuffers<Real> bodies_;
  bool unequal_moments_ = false;     // see SolverScene
  Buffer<std::uint32_t> kinematic_;  // ids of static and kinematic bodies
  Buffer<std::uint32_t> mesh_;       // by body, 0: sphere; empty: all are spheres
  Buffer<Real> restitution_of_material_;
  const Real max_restitution_;
  Buffer<Real> friction_of_material_;                    // empty if the effect is off
  Buffer<Real> rolling_of_material_, rolling_of_plane_;  // empty if the effect is off
  Buffer<WallPlane<Real>> planes_;
  Buffer<BoxSurface<Real>> box_surfaces_;
  Restitution<Real> restitution_;
};

}  // namespace collidoscope

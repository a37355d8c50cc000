#pragma once
// A reference for the bodies of a running scene, advanced step by step with the run from the state at its
// start.
//
// Scenes of hard spheres use the exact event-driven simulation (sim_cuda/reference/). Any other scene is
// simulated in double with the same solver and 1/8 of the time step. A second run with 1/4 of the time step
// estimates the error of the first. The reference ends at a Zeno point, after 20 collisions per exact sphere
// (rounding errors), or when the two runs differ by a radius.
//
// The reference continues when numerical settings (accuracy/point.h) change. Any other change restarts it
// from the present state. Owns its worlds; the run is only read.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/publish/publish.h"
#include "sim_cuda/reference/hard_spheres.h"
#include "sim_cuda/world.h"
#include "ui/reference_view.h"

namespace collidoscope {

/// Fingerprint of the physical problem as text: all settings that decide the motion, except the numerical
/// ones.
std::string problem_fingerprint(const World& world);

class LiveReference {
 public:
  static constexpr std::int64_t max_bodies = 50'000;  ///< limit, since errors are computed on the host
  /// Why a scene has no reference; empty: it can have one.
  static std::string unavailable_reason(std::int64_t bodies);

  /// Updates to the state of `world`; `generation` changes with each new World.
  void follow(World& world, int generation);
  /// Advances for about `milliseconds`, at least one own step, up to the end of the run's next step `dt`.
  /// Returns whether it is reached; the run must wait for it. Returns true if there is no reference.
  bool advance_to_next_step(double dt, double milliseconds);
  /// Call after the run has made the step.
  void stepped(double dt);
  void forget();

  /// Ghosts for the present state of `world`, ordered by id. Calls follow() first, since a step may have
  /// replaced the World. Empty if there is no reference. Passes the errors to the world
  /// (Publisher::set_errors).
  std::vector<GhostInstance> ghosts(World& world, int generation);
  const ReferenceView& view() const { return view_; }
  /// Changes when ghosts() may change for the same state.
  int version() const { return version_; }

 private:
  struct Run {  // the same scene with a smaller time step
    std::unique_ptr<World> world;
    int parts;     // steps per step of the run
    int done = 0;  // completed steps of the next step of the run
  };
  void begin(World& world);
  void fit(Run& run, double dt);
  void compare();

  int generation_ = -1;
  std::string problem_;     // fingerprint of the physical problem
  std::int64_t steps_ = 0;  // step count of the run
  double time_ = 0;         // s, since the start of the reference
  std::unique_ptr<HardSpheres> exact_;
  std::vector<Run> runs_;                       // smallest time step first
  BodyStates reference_state_, coarser_state_;  // states of the reference and of the coarser run
  bool states_known_ = false;                   // reference_state_ matches the present state
  ReferenceView view_;
  int version_ = 0;
};

}  // namespace collidoscope

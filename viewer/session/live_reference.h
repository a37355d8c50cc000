#pragma once
// Where the bodies of a running scene should be: a reference that goes along with the run, step by step, from
// the bodies as they were when somebody first asked.
//
// Exact, where the event-driven simulation of hard spheres (sim_cuda/reference/) knows the scene. Else the
// same scene in double and by the same solver, in steps an eighth as long; a second such run, in steps a
// quarter as long, is as far from it as its own error goes, about. A reference ends where it knows no more:
// at a Zeno point; after 20 collisions of each exact sphere, when rounding decides; where the two runs are a
// radius apart.
//
// What is asked of the run stays the same whatever numerical settings (accuracy/point.h) turn: the reference
// goes on then. Where anything else changes, it begins anew with the bodies as they are. Owns its worlds;
// never touches the run.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/publish/publish.h"
#include "sim_cuda/reference/hard_spheres.h"
#include "sim_cuda/world.h"
#include "ui/reference_view.h"

namespace collidoscope {

/// What a run is asked, as text: all that decides the motion but the numerical settings.
std::string problem_fingerprint(const World& world);

class LiveReference {
 public:
  static constexpr std::int64_t max_bodies = 50'000;  ///< they are compared on the host
  /// Why a scene can have none, or empty.
  static std::string unavailable_reason(std::int64_t bodies);

  /// Makes it speak of the state that `world` is in; `generation` changes whenever it is another World.
  void follow(World& world, int generation);
  /// Goes on, for about so many milliseconds and at least a step of its own, to where a step of `dt` leads
  /// the run. Returns whether it is there: the run waits for it. Where there is no reference, nothing needs
  /// to wait.
  bool advance_to_next_step(double dt, double milliseconds);
  /// The run has made the step.
  void stepped(double dt);
  void forget();

  /// Of the state that `world` is in, which it follows first: a step may have made it another World. In the
  /// order of ids; none where the reference knows nothing. Gives the errors to the world
  /// (Publisher::set_errors).
  std::vector<GhostInstance> ghosts(World& world, int generation);
  const ReferenceView& view() const { return view_; }
  /// Another one says that ghosts() are others for the same state, too.
  int version() const { return version_; }

 private:
  struct Run {  // of the same scene, more finely
    std::unique_ptr<World> world;
    int parts;     // of a step of the run
    int done = 0;  // of the step that comes
  };
  void begin(World& world);
  void fit(Run& run, double dt);
  void compare();

  int generation_ = -1;
  std::string problem_;     // what the run is asked, as text
  std::int64_t steps_ = 0;  // of the run
  double time_ = 0;         // s, since the beginning
  std::unique_ptr<HardSpheres> exact_;
  std::vector<Run> runs_;                       // the finer first
  BodyStates reference_state_, coarser_state_;  // of the state; coarser: of the second run
  bool states_known_ = false;                   // reference_state_ is of that state
  ReferenceView view_;
  int version_ = 0;
};

}  // namespace collidoscope

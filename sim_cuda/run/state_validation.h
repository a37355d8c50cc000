#pragma once
// Handling of guard findings (scene/effects.h). A failed step never enters the state.
//
// on_failure pause: the run returns to the state before the step, bit for bit. It makes no more steps until
// resume_without_guards() or World::restore().
//
// on_failure freeze: the body becomes static at its state before the step, and the step is repeated. Bodies
// that never touch it continue bit for bit as without the failure. Static and kinematic bodies cannot be
// frozen; the run pauses instead.
//
// Owned by a Simulation.

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "sim_cuda/guard/finding.h"

namespace collidoscope {

class Pipeline;
class Checkpoint;
class Simulation;
struct FirstViolation;

/// Part of World: World::validation().
class StateValidation {
 public:
  StateValidation(Simulation& run, bool is_enabled);
  ~StateValidation();
  StateValidation(const StateValidation&) = delete;
  StateValidation& operator=(const StateValidation&) = delete;

  /// The last finding. Cleared by World::restore() and resume_without_guards().
  const std::optional<Finding>& finding() const { return finding_; }
  bool paused() const { return paused_; }  ///< true: stopped at the finding
  /// Current ids of frozen bodies, ascending. Changes of settings keep them; a restart at state 0 clears
  /// them.
  const std::vector<std::uint32_t>& frozen() const { return frozen_; }
  /// Continues from the current state with guards disabled.
  void resume_without_guards();

 private:
  friend class Simulation;
  /// Applies the settings to a new pipeline.
  void set_up(Pipeline& pipeline) const;
  void before_step();
  /// Handles a violation: returns to the state before the step, repeats the step up to the violation and
  /// reads it. Then freezes the body or pauses.
  void resolve(const FirstViolation& found, std::uint32_t first_run);
  /// Replaces the set of frozen bodies. If memory is insufficient, nothing changes.
  void set_frozen(const std::vector<std::uint32_t>& bodies);
  /// Call after a state was restored.
  void restored();
  /// Call after a cancelled step was undone. If resolve() was cancelled, returns to its state.
  void recovered();

  Simulation& run_;
  bool is_enabled_;  ///< guards are enabled
  bool paused_ = false;
  std::optional<Finding> finding_;
  std::vector<std::uint32_t> frozen_;
  std::optional<std::int64_t> return_to_;  ///< state at which resolve() was cancelled
  std::unique_ptr<Checkpoint> checkpoint_;
};

}  // namespace collidoscope

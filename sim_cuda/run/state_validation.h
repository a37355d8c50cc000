#pragma once
// What a run does about what guards find (scene/effects.h). The step in which they find something is never in
// the state. The run pauses: it stands at the state before, bit for bit, and makes no more steps until
// resume_without_guards() or World::restore(). Or the body is frozen: it is fixed where it was in the state
// before, and the step is made again; everything that it never touches goes on as if there had been no
// finding. A body that no force moves cannot be frozen, and the run pauses.

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

/// A part of World: World::validation().
class StateValidation {
 public:
  StateValidation(Simulation& run, bool is_enabled);
  ~StateValidation();
  StateValidation(const StateValidation&) = delete;
  StateValidation& operator=(const StateValidation&) = delete;

  /// The last one since the start, World::restore() or resume_without_guards().
  const std::optional<Finding>& finding() const { return finding_; }
  bool paused() const { return paused_; }  ///< at the finding
  /// Bodies that are frozen, ascending, by ids of now. Other settings do not free them; a start at state 0
  /// does.
  const std::vector<std::uint32_t>& frozen() const { return frozen_; }
  /// The run goes on from the state that it stands at, without guards.
  void resume_without_guards();

 private:
  friend class Simulation;
  /// A pipeline that was made just now.
  void set_up(Pipeline& pipeline) const;
  void before_step();
  /// Goes back to the state before the step, makes the step again up to the finding, and reads it. Then
  /// freezes the body, or pauses.
  void resolve(const FirstViolation& found, std::uint32_t first_run);
  /// These bodies are what no force moves, and no others. Where memory is lacking, nothing has changed.
  void set_frozen(const std::vector<std::uint32_t>& bodies);
  /// The run is at a restored state.
  void restored();
  /// A cancelled step is undone: returns to where resolve() was cancelled.
  void recovered();

  Simulation& run_;
  bool is_enabled_;  ///< guards look
  bool paused_ = false;
  std::optional<Finding> finding_;
  std::vector<std::uint32_t> frozen_;
  std::optional<std::int64_t> return_to_;  ///< the state that resolve() was cancelled at
  std::unique_ptr<Checkpoint> checkpoint_;
};

}  // namespace collidoscope

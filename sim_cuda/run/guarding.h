#pragma once
// What a run does about what guards find (scene/effects.h). The step in which they find something is never in
// the state. The run pauses: it stands at the state before, bit for bit, and makes no more steps until
// dismiss() or World::adopt(). Or the body is frozen: it is fixed where it was in the state before, and the
// step is made again; everything that it never touches goes on as if there had been no finding. A body that
// no force moves cannot be frozen, and the run pauses.

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "sim_cuda/guard/finding.h"

namespace collidoscope {

class Pipeline;
class Rewind;
class Simulation;
struct FirstFound;

/// A part of World: World::guards().
class Guarding {
 public:
  Guarding(Simulation& run, bool watched);
  ~Guarding();
  Guarding(const Guarding&) = delete;
  Guarding& operator=(const Guarding&) = delete;

  /// The last one since the start, World::adopt() or dismiss().
  const std::optional<Finding>& finding() const { return finding_; }
  bool paused() const { return paused_; }  ///< at the finding
  /// Bodies that are frozen, ascending, by ids of now. Other settings do not free them; a start at state 0
  /// does.
  const std::vector<std::uint32_t>& frozen() const { return frozen_; }
  /// The run goes on from the state that it stands at, without guards.
  void dismiss();

 private:
  friend class Simulation;
  /// A pipeline that was made just now.
  void set_up(Pipeline& pipeline) const;
  void before_step();
  /// Goes back to the state before the step, makes the step again up to the finding, and reads it. Then
  /// freezes the body, or pauses.
  void resolve(const FirstFound& found, std::uint32_t first_run);
  /// These bodies are what no force moves, and no others. Where memory is lacking, nothing has changed.
  void set_frozen(const std::vector<std::uint32_t>& bodies);
  /// The run is at an adopted state.
  void adopted();
  /// A cancelled step is undone: returns to where resolve() was cancelled.
  void recovered();

  Simulation& run_;
  bool watched_;  ///< guards look
  bool paused_ = false;
  std::optional<Finding> finding_;
  std::vector<std::uint32_t> frozen_;
  std::optional<std::int64_t> return_to_;  ///< the state that resolve() was cancelled at
  std::unique_ptr<Rewind> rewind_;
};

}  // namespace collidoscope

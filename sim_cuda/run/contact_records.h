#pragma once
// Optional recording of contact impulses, residuals and hashes during steps. Off by default, without cost.
// Recording does not change the state.

#include <vector>

#include "sim_cuda/core/state_hashes.h"
#include "sim_cuda/solver/residual.h"
#include "sim_cuda/solver/warm_start.h"

namespace collidoscope {

class Pipeline;
class Simulation;

/// Part of World: World::records().
class ContactRecords {
 public:
  explicit ContactRecords(Simulation& run) : run_(run) {}

  /// Enables recording of the normal impulse of each contact. Used by impulses(), Publisher::publish(),
  /// World::inspect() and World::measure().
  void record_impulses(bool on);
  /// Contacts of the last step, sorted by (a, b), including contacts without an impulse. Solver `impulse`:
  /// sums over the iterations of the last substep. `soft_step`: sums over the step. Empty if the step was
  /// not recorded.
  std::vector<ContactImpulse> impulses();

  /// Enables recording of residuals after each solver iteration.
  void record_residuals(bool on);
  /// Residuals of the last step in iteration order; empty if the step was not recorded.
  std::vector<Residual> residuals();

  /// Steps compute the hashes of the state after them, so hashes() does not wait for the device.
  void record_hashes(bool on);
  /// See World.
  StateHashes hashes();

 private:
  friend class Simulation;
  /// Applies the settings to a new pipeline.
  void set_up(Pipeline& pipeline) const;
  void begin_step() { hashes_known_ = false; }
  void step_made();
  /// Call after the state was set other than by a step.
  void state_replaced() { residuals_known_ = hashes_known_ = false; }
  /// Call after a cancelled step was undone and the pipeline replaced.
  void recovered() { impulses_new_ = false; }
  /// Keeps the impulses of the last step. Call before the contact list changes.
  void keep();

  Simulation& run_;
  bool impulses_ = false;         ///< recording is on
  bool residuals_ = false;        ///< recording is on
  bool residuals_known_ = false;  ///< the last step was recorded
  bool hashes_ = false;           ///< recording is on
  bool hashes_known_ = false;     ///< the last step computed them
  bool impulses_new_ = false;     ///< the impulses match the contact list and are not kept yet
};

}  // namespace collidoscope

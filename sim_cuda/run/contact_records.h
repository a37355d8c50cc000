#pragma once
// What steps record of their contacts on request: impulses and residuals. Off at first, and then it costs
// nothing. Recording never changes the state.

#include <vector>

#include "sim_cuda/solver/residual.h"
#include "sim_cuda/solver/warm_start.h"

namespace collidoscope {

class Pipeline;
class Simulation;

/// A part of World: World::records().
class ContactRecords {
 public:
  explicit ContactRecords(Simulation& run) : run_(run) {}

  /// Whether steps record the normal impulse of each contact: for impulses(), Publisher::publish(),
  /// World::inspect() and World::measure().
  void record_impulses(bool on);
  /// The contacts of the last step, by a, then b, each with the sum over the iterations: with `impulse`, of
  /// the last substep; with `soft_step`, of all of them, including contacts without an impulse. Empty where
  /// that step was not recorded.
  std::vector<ContactImpulse> impulses();

  /// Whether steps measure what each sweep of the solver left of its contacts' errors.
  void record_residuals(bool on);
  /// Of the last step, in the order of its sweeps; empty where that step was not recorded.
  std::vector<Residual> residuals();

 private:
  friend class Simulation;
  /// A pipeline that was made just now.
  void set_up(Pipeline& pipeline) const;
  void step_made();
  /// The pipeline has another state than its steps have led to.
  void state_replaced() { residuals_known_ = false; }
  /// A cancelled step is undone, and the pipeline is another.
  void recovered() { impulses_new_ = false; }
  /// Keeps the impulses of the last step, before the list of contacts becomes another.
  void keep();

  Simulation& run_;
  bool impulses_ = false;         ///< steps record them
  bool residuals_ = false;        ///< steps record them
  bool residuals_known_ = false;  ///< the last step did
  bool impulses_new_ = false;     ///< they belong to the contacts in the list, and are not kept yet
};

}  // namespace collidoscope

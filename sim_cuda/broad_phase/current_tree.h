#pragma once
// The tree of the boxes that the broad phase has now: arranged by levels, and measured, once for each state
// and when somebody asks.

#include <cstdint>
#include <vector>

#include "sim_cuda/broad_phase/quality.h"
#include "sim_cuda/broad_phase/tree.h"

namespace collidoscope {

class CurrentTree {
 public:
  CurrentTree(Executor& executor, std::int64_t bodies) : bodies_(bodies), tree_(executor), meter_(executor) {}

  /// The boxes are others.
  void forget() { arranged_ = measured_ = leaves_known_ = false; }

  const TreeView& arranged(const BroadPhase& method);
  /// All zero where the method has no tree, but for the bytes that the method takes.
  const TreeQuality& quality(const BroadPhase& method, std::int64_t bytes);
  /// Of quality(), without the rest.
  OwnVisits own_visits(const BroadPhase& method) { return meter_.own_visits(method, bodies_); }
  /// Leaves at each level, without a measure of the tree.
  const std::vector<std::int64_t>& leaves(const BroadPhase& method);
  /// After quality().
  TreeMeter& meter() { return meter_; }

 private:
  std::int64_t bodies_;
  Tree tree_;
  TreeMeter meter_;
  TreeQuality quality_;
  std::vector<std::int64_t> leaves_;
  bool arranged_ = false, measured_ = false, leaves_known_ = false;
};

}  // namespace collidoscope

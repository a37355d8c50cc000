#pragma once
// The tree of the boxes that the broad phase has now: arranged by levels, and measured, once for each state
// and when somebody asks.

#include <cstdint>
#include <vector>

#include "sim_cuda/broad_phase/bvh_statistics.h"
#include "sim_cuda/broad_phase/tree.h"

namespace collidoscope {

class BvhCache {
 public:
  BvhCache(Executor& executor, std::int64_t bodies)
      : bodies_(bodies), tree_(executor), statistics_(executor) {}

  /// The boxes are others.
  void invalidate() { level_ordered_ = measured_ = leaves_known_ = false; }

  const TreeView& level_ordered(const BroadPhase& method);
  /// All zero where the method has no tree, but for the bytes that the method takes.
  const TreeQuality& quality(const BroadPhase& method, std::int64_t bytes);
  /// Of quality(), without the rest.
  OwnVisits own_visits(const BroadPhase& method) { return statistics_.own_visits(method, bodies_); }
  /// Leaves at each level, without a measure of the tree.
  const std::vector<std::int64_t>& leaves(const BroadPhase& method);
  /// After quality().
  BvhStatistics& statistics() { return statistics_; }

 private:
  std::int64_t bodies_;
  Tree tree_;
  BvhStatistics statistics_;
  TreeQuality quality_;
  std::vector<std::int64_t> leaves_;
  bool level_ordered_ = false, measured_ = false, leaves_known_ = false;
};

}  // namespace collidoscope

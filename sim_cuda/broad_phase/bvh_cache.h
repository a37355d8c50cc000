#pragma once
// Caches the level-ordered tree of the current boxes, and its statistics. Both are computed on demand, once
// per state.

#include <cstdint>
#include <vector>

#include "sim_cuda/broad_phase/bvh_statistics.h"
#include "sim_cuda/broad_phase/tree.h"

namespace collidoscope {

class BvhCache {
 public:
  BvhCache(Executor& executor, std::int64_t bodies)
      : bodies_(bodies), tree_(executor), statistics_(executor) {}

  /// Call this when the boxes have changed.
  void invalidate() { level_ordered_ = measured_ = leaves_known_ = false; }

  const TreeView& level_ordered(const BroadPhase& method);
  /// All members except `bytes` are 0 if the method has no tree.
  const TreeQuality& quality(const BroadPhase& method, std::int64_t bytes);
  /// Computes quality().own only.
  OwnVisits own_visits(const BroadPhase& method) { return statistics_.own_visits(method, bodies_); }
  /// Number of leaves per level. Does not compute the statistics.
  const std::vector<std::int64_t>& leaves(const BroadPhase& method);
  /// Precondition: quality() was called for the current state.
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

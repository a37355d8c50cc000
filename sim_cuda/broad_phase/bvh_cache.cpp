#include "sim_cuda/broad_phase/bvh_cache.h"

namespace collidoscope {

const TreeView& BvhCache::level_ordered(const BroadPhase& method) {
  if (!level_ordered_) tree_.build_level_order(method, bodies_);
  level_ordered_ = true;
  return tree_.view();
}

const TreeQuality& BvhCache::quality(const BroadPhase& method, std::int64_t bytes) {
  if (!measured_) {
    quality_ = statistics_.measure(level_ordered(method), bodies_);
    quality_.own = statistics_.own_visits(method, bodies_);
  }
  quality_.bytes = bytes;
  measured_ = true;
  return quality_;
}

const std::vector<std::int64_t>& BvhCache::leaves(const BroadPhase& method) {
  if (!leaves_known_) leaves_ = statistics_.leaves(level_ordered(method));
  leaves_known_ = true;
  return leaves_;
}

}  // namespace collidoscope

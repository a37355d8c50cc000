#include "sim_cuda/broad_phase/current_tree.h"

namespace collidoscope {

const TreeView& CurrentTree::arranged(const BroadPhase& method) {
  if (!arranged_) tree_.arrange(method, bodies_);
  arranged_ = true;
  return tree_.view();
}

const TreeQuality& CurrentTree::quality(const BroadPhase& method, std::int64_t bytes) {
  if (!measured_) {
    quality_ = meter_.measure(arranged(method), bodies_);
    quality_.own = meter_.own_visits(method, bodies_);
  }
  quality_.bytes = bytes;
  measured_ = true;
  return quality_;
}

const std::vector<std::int64_t>& CurrentTree::leaves(const BroadPhase& method) {
  if (!leaves_known_) leaves_ = meter_.leaves(arranged(method));
  leaves_known_ = true;
  return leaves_;
}

}  // namespace collidoscope

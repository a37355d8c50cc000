#include "sim_cuda/run/given_tree.h"

#include <utility>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/bvh_cache.h"

namespace collidoscope {
namespace {

/// A method that has only a tree.
class GivenTreeMethod final : public BroadPhase {
 public:
  GivenTreeMethod(Executor& executor, std::shared_ptr<const GivenTree> tree)
      : executor_(executor), tree_(std::move(tree)) {}

  void reserve(std::int64_t) override {}
  void update(const Aabb*, const Aabb*) override {}
  void find_pairs(const PairSink&) override {}
  std::int64_t tree_nodes() const override { return std::ssize(tree_->box); }
  void write_tree(const TreeSink& sink) const override { write_given_tree(executor_, *tree_, sink); }

 private:
  Executor& executor_;
  std::shared_ptr<const GivenTree> tree_;
};

}  // namespace

std::unique_ptr<BroadPhase> make_given_tree(Executor& executor, std::shared_ptr<const GivenTree> tree) {
  return std::make_unique<GivenTreeMethod>(executor, std::move(tree));
}

TreeQuality quality_of(const GivenTree& tree, const ExecutorOptions& options) {
  Executor executor(options);
  const GivenTreeMethod method(executor, std::shared_ptr<const GivenTree>(std::shared_ptr<void>(), &tree));
  BvhCache cache(executor, std::ssize(tree.leaf_body));
  TreeQuality quality = cache.quality(method, 0);
  quality.own = {};
  return quality;
}

}  // namespace collidoscope

#include "sim_cuda/run/given_tree.h"

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/bvh_cache.h"

namespace collidoscope {
namespace {

/// A method that has only a tree.
class GivenTreeMethod final : public BroadPhase {
 public:
  GivenTreeMethod(Executor& executor, const GivenTree& tree) : executor_(executor), tree_(tree) {}

  void reserve(std::int64_t) override {}
  void update(const Aabb*, const Aabb*) override {}
  void find_pairs(const PairSink&) override {}
  std::int64_t tree_nodes() const override { return std::ssize(tree_.box); }
  void write_tree(const TreeSink& sink) const override {
    const auto copy = [this](auto* to, const auto& from) {
      executor_.copy_to_executor(to, from.data(), from.size() * sizeof from[0]);
    };
    copy(sink.box, tree_.box);
    copy(sink.parent, tree_.parent);
    copy(sink.leaf_body, tree_.leaf_body);
  }

 private:
  Executor& executor_;
  const GivenTree& tree_;
};

}  // namespace

TreeQuality quality_of(const GivenTree& tree, const ExecutorOptions& options) {
  Executor executor(options);
  const GivenTreeMethod method(executor, tree);
  BvhCache cache(executor, std::ssize(tree.leaf_body));
  TreeQuality quality = cache.quality(method, 0);
  quality.own = {};
  return quality;
}

}  // namespace collidoscope

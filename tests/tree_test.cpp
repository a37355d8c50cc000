// Tests the generic tree view on degenerate and on real trees, against their known structure.
#include "sim_cuda/broad_phase/tree.h"
#include "sim_cuda/scene/broad_phase_methods.h"

#include <gtest/gtest.h>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/bvh_statistics.h"
#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

/// A degenerate tree: inner node i holds leaf i and inner node i + 1. The bodies lie on a line without
/// overlap, so each level separates one of them.
class ListOfLeaves final : public BroadPhase {
 public:
  ListOfLeaves(Executor& executor, std::uint32_t n) : executor_(executor), n_(n) {}
  void reserve(std::int64_t) override {}
  void update(const Aabb*, const Aabb*) override {}
  void find_pairs(const PairSink&) override {}
  std::int64_t tree_nodes() const override { return 2 * std::int64_t{n_} - 1; }
  void write_tree(const TreeSink& sink) const override {
    std::vector<Aabb> box;
    std::vector<std::uint32_t> parent, body;
    for (std::uint32_t i = 0; i < n_; ++i) {
      box.push_back(from_to(i, i));
      parent.push_back(n_ + std::min(i, n_ - 2));
      body.push_back(n_ - 1 - i);  // ids differ from places
    }
    for (std::uint32_t i = 0; i + 1 < n_; ++i) {
      box.push_back(from_to(i, n_ - 1));
      parent.push_back(n_ + std::max(i, 1u) - 1);
    }
    executor_.copy_to_executor(sink.box, box.data(), box.size() * sizeof box[0]);
    executor_.copy_to_executor(sink.parent, parent.data(), parent.size() * sizeof parent[0]);
    executor_.copy_to_executor(sink.leaf_body, body.data(), body.size() * sizeof body[0]);
  }

 private:
  static Aabb from_to(std::uint32_t first, std::uint32_t last) {
    return {Vector3f(static_cast<float>(first), 0, 0), Vector3f(static_cast<float>(last) + 0.5f, 1, 1)};
  }
  Executor& executor_;
  std::uint32_t n_;
};

class ArrangedTree : public OnEachExecutor {};
ON_EACH_EXECUTOR(ArrangedTree);

TEST_P(ArrangedTree, IsWholeHoweverDeep) {
  Executor executor(options());
  for (const std::uint32_t n : {2u, 64u, 65u, 300u}) {
    Tree tree(executor);
    tree.build_level_order(ListOfLeaves(executor, n), n);
    const TreeView& view = tree.view();
    const std::int64_t nodes = 2 * std::int64_t{n} - 1;
    ASSERT_EQ(view.nodes, nodes);
    // The root, then two nodes per level; the last level holds all deeper nodes.
    ASSERT_EQ(view.levels(), static_cast<int>(std::min(n, 64u)));
    for (int level = 1; level + 1 < view.levels(); ++level) EXPECT_EQ(view.level_size(level), 2) << n;
    std::int64_t all = 0;
    for (int level = 0; level < view.levels(); ++level) all += view.level_size(level);
    EXPECT_EQ(all, nodes);

    // A body with i others before it: its query visits 2 nodes on each of i + 1 levels.
    BvhStatistics statistics(executor);
    const TreeQuality quality = statistics.measure(view, n);
    std::int64_t visits = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::int64_t expected = 1 + 2 * std::int64_t{std::min(i, n - 2) + 1};
      EXPECT_EQ(statistics.visits_of(n - 1 - i), expected) << n << ' ' << i;
      visits += expected;
    }
    EXPECT_DOUBLE_EQ(quality.visits_mean, static_cast<double>(visits) / n);
    EXPECT_EQ(quality.pairs, 0);
    std::int64_t leaves = 0;
    for (const std::int64_t at_level : quality.leaves) leaves += at_level;
    EXPECT_EQ(leaves, n);

    // Children are adjacent, one level below their parent, and refer to it.
    std::vector<std::uint32_t> places(static_cast<std::size_t>(nodes));
    for (std::size_t k = 0; k < places.size(); ++k) places[k] = static_cast<std::uint32_t>(k);
    std::vector<int> born(places.size());
    for (const NodeReport& node : statistics.nodes(view, places)) {
      if (node.children == 0) continue;
      EXPECT_EQ(node.children, 2u);
      EXPECT_GT(node.first_child, node.node);
      for (std::uint32_t child : {node.first_child, node.first_child + 1}) ++born[child];
    }
    EXPECT_EQ(born[0], 0);
    for (std::size_t k = 1; k < born.size(); ++k) EXPECT_EQ(born[k], 1) << n << ' ' << k;
  }
}

// Bullet builds a list for coincident bodies.
TEST_P(ArrangedTree, OfCoincidentBodiesLeadsToAllPairs) {
  constexpr int n = 300;
  Scene scene = empty_space();
  for (int i = 0; i < n; ++i) scene.bodies.push_back(sphere(1, Vector3d(0, 0, 0)));
  for (const std::string& method : broad_phase_names(GetParam())) {
    RunOptions o = options();
    o.broad_phase = method;
    World world(scene, o);
    if (world.tree().nodes() == 0) continue;
    EXPECT_EQ(world.tree().quality().pairs, n * (n - 1) / 2) << method;
    std::int64_t leaves = 0;
    for (const std::int64_t at_level : world.tree().leaves()) leaves += at_level;
    EXPECT_EQ(leaves, n) << method;
  }
}

}  // namespace
}  // namespace collidoscope

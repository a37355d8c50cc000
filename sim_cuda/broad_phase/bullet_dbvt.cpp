// The incremental tree of the paper's section 3.2.3: Bullet's btDbvt. Boxes are larger than the bodies by a
// margin. A body that leaves its box is removed and re-inserted. Each step re-inserts one more leaf to
// optimise the tree. All operations are sequential, on one CPU thread. Compiled only if libbullet-dev is
// installed; never by nvcc.
//
// Bullet's boxes contain ours exactly: its number type represents all floats, margins only enlarge, and
// merging uses minima and maxima. Bullet therefore finds a superset of the pairs, which is filtered by the
// exact boxes.

#include <BulletCollision/BroadphaseCollision/btDbvt.h>

#include <utility>
#include <vector>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/pair_sink.h"

namespace collidoscope {

namespace {

/// Fraction of a box's side lengths. Bullet's own margin is 0.05 m, which suits bodies of a metre.
constexpr btScalar margin = btScalar(0.05);

btDbvtVolume volume_of(const Aabb& box) {
  const auto point = [](const Vector3f& p) {
    return btVector3(static_cast<btScalar>(p.x()), static_cast<btScalar>(p.y()),
                     static_cast<btScalar>(p.z()));
  };
  return btDbvtVolume::FromMM(point(box.min), point(box.max));
}

Aabb box_of(const btDbvtVolume& volume) {
  Aabb box;
  for (int k = 0; k < 3; ++k) {
    box.min[k] = round_down(volume.Mins()[k]);
    box.max[k] = round_up(volume.Maxs()[k]);
  }
  return box;
}

class BulletDbvt final : public BroadPhase {
 public:
  explicit BulletDbvt(Executor& executor) : executor_(executor) {}

  void reserve(std::int64_t bodies) override {
    tree_.clear();
    leaves_.assign(static_cast<std::size_t>(bodies), nullptr);
  }

  void update(const Aabb* boxes, const Aabb*) override {
    executor_.begin_stage("build", true);
    executor_.count_launches(1);
    boxes_ = boxes;
    for (btDbvtNode*& leaf : leaves_) {
      const Aabb& box = boxes[body_of(leaf)];
      if (is_empty(box)) {
        if (leaf != nullptr) tree_.remove(leaf);
        leaf = nullptr;
        continue;
      }
      btDbvtVolume volume = volume_of(box);
      if (leaf == nullptr) {
        leaf = tree_.insert(volume, &leaf);
      } else if (!leaf->volume.Contain(volume)) {
        volume.Expand(volume.Lengths() * margin);
        tree_.update(leaf, volume);
      }
    }
    tree_.optimizeIncremental(1);
  }

  void find_pairs(const PairSink& sink) override {
    executor_.begin_stage("pairs", true);
    executor_.count_launches(1);
    collide([](std::int64_t) {},
            [&](const btDbvtNode* a, const btDbvtNode* b) {
              const std::uint32_t x = body_of(a), y = body_of(b);
              if (overlap(boxes_[x], boxes_[y])) sink.add(x, y);
            });
  }
  /// Counted in total, not per query: a test of two nodes serves all bodies below both.
  void count_visits(const VisitSink& sink) const override {
    collide([&](std::int64_t tests) { *sink.shared = static_cast<std::uint64_t>(tests); },
            [](const btDbvtNode*, const btDbvtNode*) {});
  }

  std::int64_t tree_nodes() const override {
    return std::ssize(leaves_) + walk([](const btDbvtNode*, std::uint32_t, std::uint32_t) {});
  }

  void write_tree(const TreeSink& sink) const override {
    walk([&](const btDbvtNode* node, std::uint32_t number, std::uint32_t parent) {
      sink.parent[number] = parent;
      if (node == nullptr) {
        sink.box[number] = tree_.empty() ? Aabb::empty() : box_of(tree_.m_root->volume);
      } else if (node->isinternal()) {
        sink.box[number] = box_of(node->volume);
      } else {
        sink.leaf_body[number] = body_of(node);
        sink.box[number] = boxes_[sink.leaf_body[number]];
      }
    });
    // Bodies with empty boxes, which are not in Bullet's tree.
    auto number = static_cast<std::uint32_t>(tree_.m_leaves);
    for (std::uint32_t body = 0; body < leaves_.size(); ++body) {
      if (leaves_[body] != nullptr) continue;
      sink.leaf_body[number] = body;
      sink.box[number] = Aabb::empty();
      sink.parent[number] = leaves_.size() > 1 ? static_cast<std::uint32_t>(leaves_.size()) : number;
      ++number;
    }
  }

 private:
  static constexpr int deepest = 60;

  std::uint32_t body_of(btDbvtNode* const& leaf) const {
    return static_cast<std::uint32_t>(&leaf - leaves_.data());
  }
  std::uint32_t body_of(const btDbvtNode* node) const {
    return body_of(*static_cast<btDbvtNode**>(node->data));
  }

  /// Traversal of btDbvt::collideTT for the tree with itself, which does not count its tests: same node
  /// pairs, same order. Calls on_overlap(a, b) for leaves whose volumes overlap, and finally count(number of
  /// volume tests).
  template <class Count, class OnOverlap>
  void collide(const Count& count, const OnOverlap& on_overlap) const {
    using Two = std::pair<const btDbvtNode*, const btDbvtNode*>;
    std::int64_t tests = 0;
    std::vector<Two> stack;
    if (!tree_.empty()) stack.emplace_back(tree_.m_root, tree_.m_root);
    while (!stack.empty()) {
      const auto [a, b] = stack.back();
      stack.pop_back();
      if (a == b) {
        if (a->isleaf()) continue;
        stack.emplace_back(a->childs[0], a->childs[0]);
        stack.emplace_back(a->childs[1], a->childs[1]);
        stack.emplace_back(a->childs[0], a->childs[1]);
        continue;
      }
      ++tests;
      if (!Intersect(a->volume, b->volume)) continue;
      if (a->isleaf() && b->isleaf()) {
        on_overlap(a, b);
        continue;
      }
      const bool split_a = a->isinternal(), split_b = b->isinternal();
      for (int j = 0; j < (split_b ? 2 : 1); ++j)
        for (int i = 0; i < (split_a ? 2 : 1); ++i)
          stack.emplace_back(split_a ? a->childs[i] : a, split_b ? b->childs[j] : b);
    }
    count(tests);
  }

  /// Calls visit(node, number, parent's number), parents first, children from left to right, with numbers as
  /// in TreeSink. Returns the number of inner nodes. With empty boxes, an additional root (null) joins them
  /// and Bullet's tree.
  ///
  /// Coincident bodies degenerate Bullet's tree to a list. Leaves below the maximum depth of a TreeView
  /// become children of their last ancestor above it.
  template <class Visit>
  std::int64_t walk(const Visit& visit) const {
    struct Entry {
      const btDbvtNode* node;
      std::uint32_t parent;
      int depth;
    };
    constexpr std::uint32_t none = ~std::uint32_t{0};
    const auto n = static_cast<std::uint32_t>(leaves_.size());
    std::uint32_t leaf = 0, inner = n, top = none;
    if (n > 1 && static_cast<std::uint32_t>(tree_.m_leaves) < n) {
      top = inner++;
      visit(nullptr, top, top);
    }
    std::vector<Entry> stack;
    if (!tree_.empty()) stack.push_back({tree_.m_root, top, 0});
    while (!stack.empty()) {
      const Entry at = stack.back();
      stack.pop_back();
      std::uint32_t number = at.parent;
      if (at.node->isleaf() || at.depth < deepest) {
        number = at.node->isleaf() ? leaf++ : inner++;
        visit(at.node, number, at.parent == none ? number : at.parent);
      }
      if (at.node->isleaf()) continue;
      stack.push_back({at.node->childs[1], number, at.depth + 1});
      stack.push_back({at.node->childs[0], number, at.depth + 1});
    }
    return inner - n;
  }

  Executor& executor_;
  const Aabb* boxes_ = nullptr;
  btDbvt tree_;
  std::vector<btDbvtNode*> leaves_;  ///< by body; null if the box is empty
};

}  // namespace

std::unique_ptr<BroadPhase> make_bullet_dbvt(Executor& executor) {
  return std::make_unique<BulletDbvt>(executor);
}

}  // namespace collidoscope

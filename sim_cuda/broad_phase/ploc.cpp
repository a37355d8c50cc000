// PLOC: a BVH by merging nearest neighbours, after PLOC (Meister and Bittner 2018), PLOC++ (Benthin et al.
// 2022) and H-PLOC (2024). Clusters start as the bodies in Morton order. In each round, every cluster finds
// its nearest neighbour among `radius` clusters on each side: the one with the smallest common box. Mutual
// nearest neighbours merge, at the place of the left one; a scan compacts the list. Ties: the smaller i xor
// j, so that equal clusters merge in pairs 2k and 2k + 1.
//
// A recorded step needs a number of rounds that depends on n only, but the number of merges depends on the
// bodies. Therefore a schedule limits the number of clusters per round: a factor of 4/5 per round, starting
// three rounds late. A round with more clusters than scheduled merges adjacent clusters pairwise, which
// halves their number. The Box Collider never exceeds the schedule; coincident and nested boxes may.

#include <limits>
#include <utility>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/morton_order.h"
#include "sim_cuda/broad_phase/rope_tree.h"
#include "sim_cuda/core/vector_load.h"

namespace collidoscope {

namespace {

struct alignas(16) Cluster {
  float min[3];
  std::uint32_t node;
  float max[3];
  std::uint32_t unused;
};
static_assert(sizeof(Cluster) == 32);

SIM_HD inline void enclose(Cluster& a, const Cluster& b) {
  for (int k = 0; k < 3; ++k) {
    a.min[k] = min_of(a.min[k], b.min[k]);
    a.max[k] = max_of(a.max[k], b.max[k]);
  }
}

/// Half the surface area of the common box; infinity if it is not a finite number.
SIM_HD inline float distance(Cluster a, const Cluster& b) {
  enclose(a, b);
  const float x = a.max[0] - a.min[0], y = a.max[1] - a.min[1], z = a.max[2] - a.min[2];
  const float area = x * y + y * z + z * x;
  constexpr float inf = std::numeric_limits<float>::infinity();
  return area < inf ? area : inf;
}

struct StartClusters {
  const Aabb* boxes;
  std::uint32_t n;
  std::uint32_t* count;
  RopedNode* nodes;
  TreeLinks links;
  Cluster* clusters;
  SIM_HD void operator()(std::uint32_t place, std::uint32_t body) const {
    RopedNode leaf;
    leaf.set_box(boxes[body]);
    leaf.child = body;
    leaf.rope = RopedNode::none;
    store_vectorized(&nodes[place], leaf);
    Cluster cluster;
    for (int k = 0; k < 3; ++k) {
      cluster.min[k] = leaf.min[k];
      cluster.max[k] = leaf.max[k];
    }
    cluster.node = place;
    cluster.unused = 0;
    store_vectorized(&clusters[place], cluster);
    links.link[place] = TreeLinks::none;
    if (place == 0) *count = n;
  }
};

struct FindNearest {
  static constexpr std::uint32_t radius = 8;
  const Cluster* clusters;
  const std::uint32_t* count;
  std::uint32_t due;  ///< with more clusters, the round merges pairwise
  std::uint32_t* nearest;
  SIM_HD void operator()(int item) const {
    const auto i = static_cast<std::uint32_t>(item), m = *count;
    std::uint32_t best = (i ^ 1) < m ? i ^ 1 : i;
    if (m <= due) {
      const Cluster own = load_readonly(&clusters[i]);
      float least =
          best == i ? std::numeric_limits<float>::infinity() : distance(own, load_readonly(&clusters[best]));
      const std::uint32_t first = i > radius ? i - radius : 0, last = min_of(i + radius, m - 1);
      for (std::uint32_t j = first; j <= last; ++j) {
        if (j == i) continue;
        const float d = distance(own, load_readonly(&clusters[j]));
        if (d < least || (d == least && (best == i || (i ^ j) < (i ^ best)))) {
          least = d;
          best = j;
        }
      }
    }
    nearest[i] = best;
  }
};

/// Whether a cluster merges into one to its left; 0 for scanned elements beyond the count.
struct MarkMerged {
  const std::uint32_t *count, *nearest;
  std::uint32_t* merged;
  SIM_HD void operator()(int item) const {
    const auto i = static_cast<std::uint32_t>(item);
    merged[i] = i < *count && nearest[i] < i && nearest[nearest[i]] == i;
  }
};

struct MergeClusters {
  const Cluster* clusters;
  std::uint32_t n;
  const std::uint32_t *count, *nearest, *merged_before;
  std::uint32_t bound;  ///< number of scanned elements
  Cluster* next;
  std::uint32_t* next_count;
  RopedNode* nodes;
  TreeLinks links;
  SIM_HD void operator()(int item) const {
    const auto i = static_cast<std::uint32_t>(item), m = *count;
    if (i == 0) *next_count = m - merged_before[bound];
    const std::uint32_t j = nearest[i];
    const bool mutual = j != i && nearest[j] == i;
    if (mutual && j < i) return;
    Cluster cluster = load_readonly(&clusters[i]);
    if (mutual) {
      const Cluster other = load_readonly(&clusters[j]);
      // The tree has n - m inner nodes so far. This round adds one per cluster that merges into another.
      const std::uint32_t node = n + (n - m) + merged_before[j];
      links.join(cluster.node, other.node, node);
      links.link[node] = TreeLinks::none;
      RopedNode made;
      made.child = cluster.node;
      made.rope = RopedNode::none;
      enclose(cluster, other);
      for (int k = 0; k < 3; ++k) {
        made.min[k] = cluster.min[k];
        made.max[k] = cluster.max[k];
      }
      store_vectorized(&nodes[node], made);
      cluster.node = node;
    }
    store_vectorized(&next[i - merged_before[i]], cluster);
  }
};

/// `bound`: maximum number of clusters at the start of a round. `due`: scheduled number of clusters.
struct Round {
  std::uint32_t bound, due;
  static Round first(std::uint32_t clusters) { return {clusters, 2 * clusters}; }
  Round next() const {
    const std::uint32_t half = bound - bound / 2, next_bound = due > half ? due : half;
    return {next_bound < bound ? next_bound : bound, due - (due + 4) / 5};
  }
};

template <class Key>
class Ploc final : public RopeTreeMethod<Key> {
  using Base = RopeTreeMethod<Key>;
  using Base::executor_, Base::n_, Base::nodes_, Base::order_;

 public:
  explicit Ploc(Executor& executor)
      : Base(executor, LeafOrder::any),
        link_(executor, "node links"),
        clusters_(executor, "clusters"),
        next_(executor, "clusters"),
        nearest_(executor, "nearest clusters"),
        merged_(executor, "merged clusters"),
        before_(executor, "merged clusters"),
        counts_(executor, "clusters per round"),
        temporary_(executor, "scan workspace") {}

  void reserve(std::int64_t bodies) override {
    Base::reserve(bodies);
    link_.resize_discarding(nodes_.size());
    for (Buffer<Cluster>* each : {&clusters_, &next_}) each->resize_discarding(n_);
    nearest_.resize_discarding(n_);
    for (Buffer<std::uint32_t>* each : {&merged_, &before_})
      each->resize_discarding(static_cast<std::size_t>(n_) + 1);
    std::size_t rounds = 0;
    for (Round round = Round::first(n_); round.bound > 1; round = round.next()) ++rounds;
    counts_.resize_discarding(rounds + 1);
    temporary_.resize_discarding(scan_temporary_bytes(executor_, bodies));
  }

  void update(const Aabb* boxes, const Aabb* extent) override {
    if (n_ == 0) return;
    const TreeLinks links{link_.data()};
    Cluster *clusters = clusters_.data(), *next = next_.data();
    std::uint32_t* count = counts_.data();
    order_.sort(boxes, extent, StartClusters{boxes, n_, count, nodes_.data(), links, clusters});
    for (Round round = Round::first(n_); round.bound > 1; round = round.next(), ++count) {
      const ItemCount active(count, round.bound);
      executor_.run("build", active, FindNearest{clusters, count, round.due, nearest_.data()});
      executor_.run("build", round.bound, MarkMerged{count, nearest_.data(), merged_.data()});
      exclusive_scan(executor_, "build", round.bound, merged_.data(), before_.data(), temporary_.data(),
                     temporary_.bytes());
      executor_.run("build", active,
                    MergeClusters{clusters, n_, count, nearest_.data(), before_.data(), round.bound, next,
                                  count + 1, nodes_.data(), links});
      std::swap(clusters, next);
    }
    executor_.run("build", Base::tree_nodes(), SetEscapeIndices{links, nodes_.data()});
  }

  void write_tree(const TreeSink& sink) const override {
    if (n_ > 0) write_rope_tree(executor_, n_, nodes_.data(), {link_.data()}, sink);
  }

 private:
  Buffer<std::uint32_t> link_;
  Buffer<Cluster> clusters_, next_;
  Buffer<std::uint32_t> nearest_, merged_, before_, counts_;
  Buffer<std::byte> temporary_;
};

}  // namespace

std::unique_ptr<BroadPhase> make_ploc(Executor& executor) {
  if (executor.options().key_bits == 63) return std::make_unique<Ploc<std::uint64_t>>(executor);
  return std::make_unique<Ploc<std::uint32_t>>(executor);
}

}  // namespace collidoscope

// A BVH by merging nearest neighbours, after PLOC (Meister and Bittner 2018), PLOC++ (Benthin et al. 2022)
// and H-PLOC (2024). Clusters start as the bodies in Morton order. In each round every cluster looks for its
// nearest among the `radius` to its left and to its right: the one with which it makes the smallest box. Two
// that name each other merge, in the place of the left one; a scan closes the gaps. Equally near: the one
// whose number differs in lower bits (the smaller i xor j), so that equal clusters pair up, 2k with 2k + 1.
//
// A recorded step needs a number of rounds that n fixes, but how many merge is up to the bodies. So there is
// a schedule, by which the host knows how many clusters are left at most: four of five in each round, after a
// start of three. A round that finds more than are due merges neighbours pairwise instead, which leaves half.
// The Box Collider never falls behind; coincident and nested boxes may.

#include <limits>
#include <utility>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/morton_order.h"
#include "sim_cuda/broad_phase/rope_tree.h"
#include "sim_cuda/core/whole_record.h"

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

/// Half the area of the box around both; boxes that leave no number for it are as far as can be.
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
    store_whole(&nodes[place], leaf);
    Cluster cluster;
    for (int k = 0; k < 3; ++k) {
      cluster.min[k] = leaf.min[k];
      cluster.max[k] = leaf.max[k];
    }
    cluster.node = place;
    cluster.unused = 0;
    store_whole(&clusters[place], cluster);
    links.link[place] = TreeLinks::none;
    if (place == 0) *count = n;
  }
};

struct FindNearest {
  static constexpr std::uint32_t radius = 8;
  const Cluster* clusters;
  const std::uint32_t* count;
  std::uint32_t due;  ///< with more clusters the round merges pairwise
  std::uint32_t* nearest;
  SIM_HD void operator()(int item) const {
    const auto i = static_cast<std::uint32_t>(item), m = *count;
    std::uint32_t best = (i ^ 1) < m ? i ^ 1 : i;
    if (m <= due) {
      const Cluster own = load_whole(&clusters[i]);
      float least =
          best == i ? std::numeric_limits<float>::infinity() : distance(own, load_whole(&clusters[best]));
      const std::uint32_t first = i > radius ? i - radius : 0, last = min_of(i + radius, m - 1);
      for (std::uint32_t j = first; j <= last; ++j) {
        if (j == i) continue;
        const float d = distance(own, load_whole(&clusters[j]));
        if (d < least || (d == least && (best == i || (i ^ j) < (i ^ best)))) {
          least = d;
          best = j;
        }
      }
    }
    nearest[i] = best;
  }
};

/// Whether a cluster merges into one to its left. Zero for the rest of what is scanned.
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
  std::uint32_t bound;  ///< elements that were scanned
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
    Cluster cluster = load_whole(&clusters[i]);
    if (mutual) {
      const Cluster other = load_whole(&clusters[j]);
      // n - m inner nodes are there already; this round adds one for each cluster that merges into another.
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
      store_whole(&nodes[node], made);
      cluster.node = node;
    }
    store_whole(&next[i - merged_before[i]], cluster);
  }
};

/// What a round starts with at most, and with how many it may still take its time.
struct Round {
  std::uint32_t bound, due;
  static Round first(std::uint32_t clusters) { return {clusters, 2 * clusters}; }
  Round next() const {
    const std::uint32_t half = bound - bound / 2, most = due > half ? due : half;
    return {most < bound ? most : bound, due - (due + 4) / 5};
  }
};

template <class Key>
class Ploc final : public RopeTreeMethod<Key> {
  using Base = RopeTreeMethod<Key>;
  using Base::executor_, Base::n_, Base::nodes_, Base::order_;

 public:
  explicit Ploc(Executor& executor)
      : Base(executor),
        link_(executor, "links of nodes"),
        clusters_(executor, "clusters"),
        next_(executor, "clusters"),
        nearest_(executor, "nearest clusters"),
        merged_(executor, "merged clusters"),
        before_(executor, "merged clusters"),
        counts_(executor, "clusters by round"),
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
      const ItemCount there(count, round.bound);
      executor_.run("build", there, FindNearest{clusters, count, round.due, nearest_.data()});
      executor_.run("build", round.bound, MarkMerged{count, nearest_.data(), merged_.data()});
      exclusive_scan(executor_, "build", round.bound, merged_.data(), before_.data(), temporary_.data(),
                     temporary_.bytes());
      executor_.run("build", there,
                    MergeClusters{clusters, n_, count, nearest_.data(), before_.data(), round.bound, next,
                                  count + 1, nodes_.data(), links});
      std::swap(clusters, next);
    }
    executor_.run("build", Base::tree_nodes(), TieRopes{links, nodes_.data()});
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

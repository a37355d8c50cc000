// BvhStatistics: sums over nodes and over the queries of all bodies. Single nodes: node_ranking.cpp.

#include "sim_cuda/broad_phase/bvh_statistics.h"

#include <algorithm>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/pair_sink.h"
#include "sim_cuda/broad_phase/tree_walk.h"
#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/reduce.h"

namespace collidoscope {

SIM_HD inline NodeSums combine(const NodeSums& a, const NodeSums& b) {
  return {a.area + b.area,   a.overlap + b.overlap, a.empty + b.empty, a.sides + b.sides,
          a.faces + b.faces, a.volume + b.volume,   a.inner + b.inner};
}

SIM_HD inline QuerySums combine(const QuerySums& a, const QuerySums& b) {
  return {a.q1 + b.q1,   a.q2 + b.q2,         a.q3 + b.q3,      a.area + b.area,
          a.epo + b.epo, a.visits + b.visits, a.pairs + b.pairs};
}

namespace {

// In double: products of three float extents from 1e-7 to 1e6 m.
struct Extent {
  double x, y, z;
  SIM_HD explicit Extent(const Aabb& box) : x(side(box, 0)), y(side(box, 1)), z(side(box, 2)) {}
  SIM_HD static double side(const Aabb& box, int axis) {
    return max_of(static_cast<double>(box.max[axis]) - static_cast<double>(box.min[axis]), 0.0);
  }
  SIM_HD double area() const { return 2 * (x * y + y * z + z * x); }
  SIM_HD double volume() const { return x * y * z; }
};

SIM_HD inline Aabb intersection(const Aabb& a, const Aabb& b) {
  Aabb common;
  for (int k = 0; k < 3; ++k) {
    common.min[k] = max_of(a.min[k], b.min[k]);
    common.max[k] = min_of(a.max[k], b.max[k]);
  }
  return common;
}

SIM_HD inline double ratio(double part, double whole) { return whole > 0 ? part / whole : 0; }

struct MeasureNode {
  TreeView tree;
  SIM_HD NodeSums operator()(std::int64_t item) const {
    const Aabb box = tree.box[item];
    const Extent extent(box);
    const std::uint32_t first = tree.first_child[item], count = tree.children[item];
    NodeSums node;
    node.area = extent.area() * (count == 0 ? 2 : 1);
    node.sides = extent.x + extent.y + extent.z;
    node.faces = extent.area() / 2;
    node.volume = extent.volume();
    if (count > 0) {
      double filled = 0, common_area = 0;
      for (std::uint32_t i = first; i < first + count; ++i) {
        filled += Extent(tree.box[i]).volume();
        for (std::uint32_t j = i + 1; j < first + count; ++j) {
          if (!collidoscope::overlap(tree.box[i], tree.box[j])) continue;
          const Extent common(intersection(tree.box[i], tree.box[j]));
          common_area += common.area();
          filled -= common.volume();
        }
      }
      node.inner = 1;
      node.overlap = ratio(common_area, extent.area());
      node.empty = clamp_to(1 - ratio(filled, extent.volume()), 0.0, 1.0);
    }
    return node;
  }
};

struct StoreNode {
  MeasureNode measure;
  double whole_area;
  const std::uint32_t* visits;
  float *sah_share, *overlap, *empty, *visited;
  SIM_HD void operator()(int item) const {
    const NodeSums node = measure(item);
    sah_share[item] = static_cast<float>(ratio(node.area, whole_area));
    overlap[item] = static_cast<float>(node.overlap);
    empty[item] = static_cast<float>(node.empty);
    visited[item] = static_cast<float>(visits[item]);
  }
};

struct StoreLevel {
  float level;
  float* out;
  SIM_HD void operator()(int item) const { out[item] = level; }
};

/// The area of those faces of a body's box that are inside a node, clipped to the node.
SIM_HD inline double area_within(const Aabb& body, const Aabb& node) {
  const Aabb common = intersection(body, node);
  const Extent extent(common);
  const double face[3] = {extent.y * extent.z, extent.z * extent.x, extent.x * extent.y};
  double area = 0;
  for (int k = 0; k < 3; ++k) {
    if (common.min[k] == body.min[k]) area += face[k];
    if (common.max[k] == body.max[k]) area += face[k];
  }
  return area;
}

/// The query of one body, by its leaf.
struct Query {
  TreeView tree;
  std::uint32_t *node_visits, *body_visits, *leaf_visits, *overlaps;
  double* epo;
  const std::uint32_t* leaf_node;
  SIM_HD void operator()(int place) const {
    const std::uint32_t leaf = leaf_node[place];
    const Aabb box = tree.box[leaf];
    std::uint32_t visits = 0, found = 0;
    double outside = 0;
    walk(tree, [&](std::uint32_t node) {
      ++visits;
      atomic_add(&node_visits[node], 1);
      const Aabb node_box = tree.box[node];
      if (!overlap(box, node_box)) return false;
      if (tree.children[node] == 0) found += node != leaf;
      if (!contains(node, leaf)) outside += area_within(box, node_box) * (tree.children[node] == 0 ? 2 : 1);
      return true;
    });
    body_visits[tree.body[leaf]] = leaf_visits[place] = visits;
    overlaps[place] = found;
    epo[place] = outside;
  }
  SIM_HD bool contains(std::uint32_t node, std::uint32_t leaf) const {
    while (leaf > node) leaf = tree.parent[leaf];  // parents precede their children
    return leaf == node;
  }
};

/// The query without statistics, for timing.
struct CountOverlaps {
  TreeView tree;
  const std::uint32_t* leaf_node;
  std::uint32_t* overlaps;
  SIM_HD void operator()(int place) const {
    const std::uint32_t leaf = leaf_node[place];
    const Aabb box = tree.box[leaf];
    std::uint32_t found = 0;
    walk(tree, [&](std::uint32_t node) {
      const bool hit = overlap(box, tree.box[node]);
      found += hit && node != leaf && tree.children[node] == 0;
      return hit;
    });
    overlaps[place] = found;
  }
};

struct LeafNodes {
  TreeView tree;
  const std::uint32_t* place_of_body;
  std::uint32_t* leaf_node;
  SIM_HD void operator()(int node) const {
    if (tree.body[node] != TreeView::inner)
      leaf_node[place_of_body[tree.body[node]]] = static_cast<std::uint32_t>(node);
  }
};

struct PlacesOfBodies {
  const std::uint32_t* leaf_body;
  std::uint32_t* place;
  SIM_HD void operator()(int k) const { place[leaf_body[k]] = static_cast<std::uint32_t>(k); }
};

struct LoadQuery {
  TreeView tree;
  const std::uint32_t *leaf_node, *leaf_visits, *overlaps;
  const double* epo;
  SIM_HD QuerySums operator()(std::int64_t place) const {
    const Extent extent(tree.box[leaf_node[place]]);
    const double q = extent.x / 2;  // boxes of spheres are cubes
    QuerySums sums;
    sums.q1 = q;
    sums.q2 = q * q;
    sums.q3 = q * q * q;
    sums.area = extent.area();
    sums.epo = epo[place];
    sums.visits = leaf_visits[place];
    sums.pairs = overlaps[place];
    return sums;
  }
};

/// Counts the leaves among the nodes of one level.
struct CountLeavesBelow {
  const std::uint32_t* children;
  std::uint32_t* count;
  SIM_HD void operator()(int node) const {
    if (children[node] == 0) atomic_add(count, 1);
  }
};

struct WriteVisited {
  TreeView tree;
  std::uint32_t body;
  const std::uint32_t *place_of_body, *leaf_node;
  std::uint32_t limit;
  std::uint32_t* list;  // {count, nodes...}
  SIM_HD void operator()(int) const {
    const Aabb box = tree.box[leaf_node[place_of_body[body]]];
    std::uint32_t count = 0;
    walk(tree, [&](std::uint32_t node) {
      if (count < limit) list[1 + count] = node;
      ++count;
      return overlap(box, tree.box[node]);
    });
    list[0] = count;
  }
};

/// Distribution of the visits of n >= 1 queries.
struct QueryDistribution {
  std::uint32_t min = 0, p99 = 0, max = 0;
  double of_warps = 0;  ///< mean over groups of 32 consecutive queries of their maximum

  explicit QueryDistribution(std::vector<std::uint32_t> visits) {
    constexpr std::size_t warp = 32;
    std::size_t warps = 0;
    for (auto first = visits.begin(); first != visits.end(); ++warps) {
      const auto end = first + std::min<std::ptrdiff_t>(warp, visits.end() - first);
      of_warps += *std::max_element(first, end);
      first = end;
    }
    of_warps /= static_cast<double>(warps);
    const auto at = visits.begin() + (std::ssize(visits) - 1) * 99 / 100;
    std::nth_element(visits.begin(), at, visits.end());
    p99 = *at;
    max = *std::max_element(at, visits.end());
    min = *std::min_element(visits.begin(), at + 1);
  }
};

}  // namespace

BvhStatistics::BvhStatistics(Executor& executor)
    : executor_(executor),
      level_(executor, "node levels"),
      sah_share_(executor, "node SAH cost shares"),
      overlap_(executor, "sibling overlaps"),
      empty_(executor, "node empty space"),
      visited_(executor, "node visits"),
      node_visits_(executor, "node visits"),
      body_visits_(executor, "body visits"),
      leaf_visits_(executor, "body visits"),
      overlaps_(executor, "box overlaps per body"),
      leaf_node_(executor, "body leaf nodes"),
      place_(executor, "body leaf order"),
      own_visits_(executor, "query visits"),
      shared_visits_(executor, "query visits"),
      epo_(executor, "end point overlap"),
      node_sums_(executor, "node sums"),
      query_sums_(executor, "query sums"),
      key_(executor, "rank keys"),
      sorted_key_(executor, "rank keys"),
      id_(executor, "unsorted nodes"),
      order_(executor, "ranked nodes"),
      spans_(executor, "value ranges"),
      edges_(executor, "bin edges"),
      counts_(executor, "bin counts"),
      temporary_(executor, "sort workspace") {}

TreeQuality BvhStatistics::measure(const TreeView& tree, std::int64_t bodies) {
  TreeQuality quality;
  quality.bodies = bodies;
  quality.nodes = tree.nodes;
  quality.levels = tree.levels();
  if (tree.nodes == 0) return quality;
  const auto nodes = static_cast<std::size_t>(tree.nodes), n = static_cast<std::size_t>(bodies);
  for (Buffer<float>* values : {&level_, &sah_share_, &overlap_, &empty_, &visited_})
    values->resize_discarding(nodes);
  node_visits_.resize_discarding(nodes);
  for (Buffer<std::uint32_t>* counts : {&body_visits_, &leaf_visits_, &overlaps_, &leaf_node_, &place_})
    counts->resize_discarding(n);
  epo_.resize_discarding(n);
  node_sums_.resize_discarding(reduce_scratch_size(tree.nodes));
  query_sums_.resize_discarding(reduce_scratch_size(bodies));

  executor_.begin_stage("quality");
  node_visits_.fill_zero();
  executor_.run("quality", bodies, PlacesOfBodies{tree.leaf_body, place_.data()});
  executor_.run("quality", tree.nodes, LeafNodes{tree, place_.data(), leaf_node_.data()});
  executor_.run("quality", bodies,
                Query{tree, node_visits_.data(), body_visits_.data(), leaf_visits_.data(), overlaps_.data(),
                      epo_.data(), leaf_node_.data()});
  NodeSums over_nodes;
  executor_.copy_to_host(
      &over_nodes, reduce<NodeSums>(executor_, "quality", tree.nodes, MeasureNode{tree}, node_sums_.data()),
      sizeof over_nodes);
  QuerySums over_queries;
  executor_.copy_to_host(&over_queries,
                         reduce<QuerySums>(executor_, "quality", bodies,
                                           LoadQuery{tree, leaf_node_.data(), leaf_visits_.data(),
                                                     overlaps_.data(), epo_.data()},
                                           query_sums_.data()),
                         sizeof over_queries);
  executor_.run("quality", tree.nodes,
                StoreNode{MeasureNode{tree}, over_nodes.area, node_visits_.data(), sah_share_.data(),
                          overlap_.data(), empty_.data(), visited_.data()});
  for (int level = 0; level < tree.levels(); ++level)
    executor_.run("quality", tree.level_size(level),
                  StoreLevel{static_cast<float>(level), level_.data() + tree.level_begin(level)});

  Aabb root;
  executor_.copy_to_host(&root, tree.box, sizeof root);
  const Extent whole(root);
  const auto count = static_cast<double>(bodies);
  quality.sah = ratio(over_nodes.area, whole.area());
  quality.epo = ratio(over_queries.epo, over_queries.area);
  quality.sah_epo = 0.29 * quality.sah + 0.71 * quality.epo;
  quality.sibling_overlap = ratio(over_nodes.overlap, over_nodes.inner);
  quality.empty_space = ratio(over_nodes.empty, over_nodes.inner);
  quality.expected_visits = ratio(
      over_nodes.volume + (2 * over_queries.q1 * over_nodes.faces + 4 * over_queries.q2 * over_nodes.sides +
                           8 * over_queries.q3 * static_cast<double>(tree.nodes)) /
                              count,
      whole.volume());
  quality.pairs = over_queries.pairs / 2;
  quality.tests_per_pair = ratio(over_queries.visits, static_cast<double>(over_queries.pairs));
  quality.visits_mean = over_queries.visits / count;

  const QueryDistribution distribution(leaf_visits_.download());
  quality.warp_ratio = distribution.of_warps / quality.visits_mean;
  quality.visits_p99 = distribution.p99;
  quality.visits_max = distribution.max;
  quality.visits_min = distribution.min;
  quality.leaves = leaves(tree);
  return quality;
}

OwnVisits BvhStatistics::own_visits(const BroadPhase& method, std::int64_t bodies) {
  OwnVisits own;
  if (bodies == 0 || method.tree_nodes() == 0) return own;
  own_visits_.resize_discarding(static_cast<std::size_t>(bodies));
  shared_visits_.resize_discarding(1);
  executor_.begin_stage("quality");
  own_visits_.fill_zero();
  shared_visits_.fill_zero();
  method.count_visits({own_visits_.data(), shared_visits_.data()});
  executor_.synchronize();
  const std::vector<std::uint32_t> visits = own_visits_.download();
  const std::uint64_t shared = shared_visits_.download()[0];
  double all = static_cast<double>(shared);
  for (const std::uint32_t of_query : visits) all += of_query;
  own.mean = all / static_cast<double>(bodies);
  own.by_query = shared == 0;
  if (!own.by_query) return own;
  const QueryDistribution distribution(visits);
  own.p99 = distribution.p99;
  own.max = distribution.max;
  own.warp_ratio = ratio(distribution.of_warps, own.mean);
  return own;
}

std::vector<std::int64_t> BvhStatistics::leaves(const TreeView& tree) {
  counts_.resize_discarding(static_cast<std::size_t>(tree.levels()));
  counts_.fill_zero();
  for (int level = 0; level < tree.levels(); ++level)
    executor_.run("quality", tree.level_size(level),
                  CountLeavesBelow{tree.children + tree.level_begin(level), counts_.data() + level});
  const std::vector<std::uint32_t> counts = counts_.download();
  return {counts.begin(), counts.end()};
}

void BvhStatistics::enqueue_queries(const TreeView& tree) {
  executor_.run("quality", static_cast<std::int64_t>(leaf_node_.size()),
                CountOverlaps{tree, leaf_node_.data(), overlaps_.data()});
}

std::int64_t BvhStatistics::visits_of(std::uint32_t body) const {
  std::uint32_t visits = 0;
  executor_.copy_to_host(&visits, body_visits_.data() + body, sizeof visits);
  return visits;
}

std::vector<std::uint32_t> BvhStatistics::visited(const TreeView& tree, std::uint32_t body,
                                                  std::int64_t limit) {
  Buffer<std::uint32_t> list(executor_, "visited nodes");
  list.resize_discarding(static_cast<std::size_t>(limit) + 1);
  executor_.run("quality", 1,
                WriteVisited{tree, body, place_.data(), leaf_node_.data(), static_cast<std::uint32_t>(limit),
                             list.data()});
  std::vector<std::uint32_t> host = list.download();
  host.resize(1 + static_cast<std::size_t>(std::min<std::int64_t>(host[0], limit)));
  host.erase(host.begin());
  return host;
}

}  // namespace collidoscope

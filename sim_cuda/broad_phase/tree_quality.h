#pragma once
// How good a hierarchy is, in numbers. Plain data.

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace collidoscope {

/// Of a node: what the tree panel colours, sorts and lists by.
enum class NodeMetric : std::uint32_t { level, sah_share, sibling_overlap, empty_space, visits };

/// Leaves have no children whose overlap or emptiness one could name.
constexpr bool has_leaf_values(NodeMetric metric) {
  return metric != NodeMetric::sibling_overlap && metric != NodeMetric::empty_space;
}
/// These span powers of ten, and are shown in even steps of their logarithm.
constexpr bool is_logarithmic(NodeMetric metric) {
  return metric == NodeMetric::sah_share || metric == NodeMetric::visits;
}

/// The nodes that somebody looks at: by level, and by the value of a metric; all inclusive.
struct NodeSelection {
  int first_level = 0, last_level = 63;
  float low = 0, high = std::numeric_limits<float>::infinity();
};

/// How the values of a metric spread over the nodes of some levels; those that have none are left out.
struct NodeHistogram {
  static constexpr std::size_t bins = 48;
  std::int64_t count = 0;   ///< nodes that have a value
  std::int64_t inside = 0;  ///< of them those from `low` to `high`
  float least = 0, greatest = 0;
  std::array<float, bins + 1>
      edge{};  ///< ascending, of the logarithm in even steps where the metric calls for it
  std::array<std::int64_t, bins>
      nodes{};  ///< of each bin, which holds its lower edge; the last one holds both
};

struct NodeReport {
  std::uint32_t node = 0;  ///< its place, level by level from the root
  int level = 0;
  std::uint32_t children = 0;     ///< 0: a leaf
  std::uint32_t first_child = 0;  ///< place; the others follow it
  std::uint32_t body = 0;         ///< of a leaf
  float min[3] = {}, max[3] = {};
  double sah_share = 0;        ///< of the tree's whole SAH cost
  double sibling_overlap = 0;  ///< area of its children's common part over its own; of a leaf 0
  double empty_space = 0;      ///< part of its volume in no child; of a leaf 0
  std::int64_t visits = 0;     ///< queries that test its box
};

/// What a method's own traversal reads, which finds the pairs: nodes whose box or planes, or bodies whose box
/// it fetches, for one query.
struct OwnVisits {
  double mean = 0;
  /// Whether the rest is known: not where the traversal has no query of a single body (bullet_dbvt).
  bool by_query = false;
  double p99 = 0;
  std::int64_t max = 0;
  double warp_ratio = 0;  ///< mean over 32 queries that follow each other of their most visits, over the mean
};

/// `visits`: of a query that starts at the root of the tree, as it is drawn, and finds all that a body
/// overlaps. It is the same for every method, and so compares trees; no method finds its pairs by it. A box
/// is visited if its parent's overlaps the body's.
struct TreeQuality {
  std::int64_t bodies = 0, nodes = 0, bytes = 0;  ///< bytes: of the method, tree and all
  int levels = 0;                                 ///< 64 at most: the last is of all nodes as deep or deeper
  double sah = 0;              ///< sum of areas of nodes and of bodies' boxes, over the root's (both costs 1)
  double epo = 0;              ///< end point overlap, Aila, Karras, Laine 2013, of the bodies' boxes
  double sah_epo = 0;          ///< 0.29 sah + 0.71 epo, theirs for rays
  double sibling_overlap = 0;  ///< mean over inner nodes
  double empty_space = 0;      ///< mean over inner nodes
  std::vector<std::int64_t> leaves;  ///< at each level; at the 64th, of all that are deeper, too
  double visits_mean = 0;            ///< per query
  double visits_p99 = 0;
  std::int64_t visits_min = 0, visits_max = 0;
  double warp_ratio =
      0;  ///< mean over 32 neighbours in the tree's order of their most visits, over visits_mean
  double expected_visits =
      0;  ///< mean over queries of the sum over nodes of prod(extent + 2 query) / root's volume
  std::int64_t pairs = 0;
  double tests_per_pair =
      0;  ///< box tests of all queries over twice the pairs: both queries of a pair find it
  OwnVisits own;
};

}  // namespace collidoscope

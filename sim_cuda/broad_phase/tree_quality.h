#pragma once
// Quality measures of a hierarchy. Plain data.

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace collidoscope {

/// Metrics of a node, which the tree panel uses for colours, sorting and lists.
enum class NodeMetric : std::uint32_t { level, sah_share, sibling_overlap, empty_space, visits };

/// Whether leaves have a value. Leaves have no children, so no overlap or empty space.
constexpr bool has_leaf_values(NodeMetric metric) {
  return metric != NodeMetric::sibling_overlap && metric != NodeMetric::empty_space;
}
/// Whether the metric spans powers of ten, and is shown on a logarithmic scale.
constexpr bool is_logarithmic(NodeMetric metric) {
  return metric == NodeMetric::sah_share || metric == NodeMetric::visits;
}

/// Selected nodes: by level, and by the value of a metric. All bounds are inclusive.
struct NodeSelection {
  int first_level = 0, last_level = 63;
  float low = 0, high = std::numeric_limits<float>::infinity();
};

/// Distribution of a metric over the nodes of some levels. Nodes without a value are excluded.
struct NodeHistogram {
  static constexpr std::size_t bins = 48;
  std::int64_t count = 0;   ///< nodes with a value
  std::int64_t inside = 0;  ///< nodes with a value from `low` to `high`
  float least = 0, greatest = 0;
  /// Ascending; equal steps of the value, or of its logarithm if the metric is logarithmic.
  std::array<float, bins + 1> edge{};
  /// Nodes per bin; a bin includes its lower edge, the last bin both edges.
  std::array<std::int64_t, bins> nodes{};
};

struct NodeReport {
  std::uint32_t node = 0;  ///< place in level order
  int level = 0;
  std::uint32_t children = 0;     ///< 0 for a leaf
  std::uint32_t first_child = 0;  ///< place; the other children follow
  std::uint32_t body = 0;         ///< body of a leaf
  float min[3] = {}, max[3] = {};
  double sah_share = 0;        ///< share of the tree's total SAH cost
  double sibling_overlap = 0;  ///< area of the children's intersection over its own; 0 for a leaf
  double empty_space = 0;      ///< fraction of its volume outside all children; 0 for a leaf
  std::int64_t visits = 0;     ///< queries that test its box
};

/// Visits per query of the method's own traversal: nodes whose box or planes it reads, and bodies whose box
/// it reads.
struct OwnVisits {
  double mean = 0;
  /// Whether the other values are known. False if the traversal has no queries of single bodies
  /// (bullet_dbvt).
  bool by_query = false;
  double p99 = 0;
  std::int64_t max = 0;
  /// Mean over groups of 32 consecutive queries of their maximum visits, divided by the mean.
  double warp_ratio = 0;
};

/// `visits`: box tests of a reference query, which starts at the root and finds all overlapping bodies. A box
/// is tested if its parent's box overlaps the body's. The query is the same for all methods, so it compares
/// trees; no method uses it to find pairs.
struct TreeQuality {
  std::int64_t bodies = 0, nodes = 0, bytes = 0;  ///< bytes: all memory of the method
  int levels = 0;                                 ///< at most 64; the last level includes all deeper nodes
  double sah = 0;      ///< area sum of nodes and bodies' boxes, divided by the root's area (both costs are 1)
  double epo = 0;      ///< end point overlap (Aila, Karras, Laine 2013) of the bodies' boxes
  double sah_epo = 0;  ///< 0.29 sah + 0.71 epo, their fit for rays
  double sibling_overlap = 0;        ///< mean over inner nodes
  double empty_space = 0;            ///< mean over inner nodes
  std::vector<std::int64_t> leaves;  ///< per level; level 63 includes all deeper leaves
  double visits_mean = 0;            ///< per query
  double visits_p99 = 0;
  std::int64_t visits_min = 0, visits_max = 0;
  /// Mean over groups of 32 adjacent leaves of their maximum visits, divided by visits_mean.
  double warp_ratio = 0;
  /// Mean over queries of the sum over nodes of prod(extent + 2 query), divided by the root's volume.
  double expected_visits = 0;
  std::int64_t pairs = 0;
  /// Box tests of all queries divided by twice the pairs, because both queries of a pair find it.
  double tests_per_pair = 0;
  OwnVisits own;
};

}  // namespace collidoscope

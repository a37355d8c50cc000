// BvhStatistics: reports, ranking and histograms of single nodes.

#include <algorithm>
#include <bit>
#include <cmath>

#include "sim_cuda/broad_phase/bvh_statistics.h"
#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/reduce.h"
#include "sim_cuda/core/sort.h"

namespace collidoscope {

SIM_HD inline ValueSpan combine(const ValueSpan& a, const ValueSpan& b) {
  if (a.count == 0) return b;
  if (b.count == 0) return a;
  return {min_of(a.least, b.least), max_of(a.greatest, b.greatest), a.count + b.count};
}

namespace {

struct GatheredNode {
  Aabb box;
  std::uint32_t children, first_child, body;
  float sah_share, overlap, empty;
  std::uint32_t visits;
};

/// The value of a node; none for leaves without a value.
struct LoadValue {
  const float* values;
  const std::uint32_t* children;
  bool leaves;
  SIM_HD ValueSpan operator()(std::int64_t node) const {
    if (!leaves && children[node] == 0) return {};
    return {values[node], values[node], 1};
  }
};

struct CountValues {
  LoadValue load;
  const float* edge;  ///< edges of NodeHistogram::bins bins
  float low, high;
  std::uint32_t* count;  ///< per bin, followed by the count of values from low to high
  SIM_HD void operator()(int node) const {
    const ValueSpan value = load(node);
    if (value.count == 0) return;
    std::size_t bin = 0, end = NodeHistogram::bins;
    while (end - bin > 1) {
      const std::size_t middle = (bin + end) / 2;
      (edge[middle] <= value.least ? bin : end) = middle;
    }
    atomic_add(&count[bin], 1);
    if (low <= value.least && value.least <= high) atomic_add(&count[NodeHistogram::bins], 1);
  }
};

/// Gathers the data of one node in one record, so that the host needs a single copy.
struct GatherNode {
  TreeView tree;
  const std::uint32_t* place;
  const float *sah_share, *overlap, *empty;
  const std::uint32_t* visits;
  GatheredNode* out;
  SIM_HD void operator()(int item) const {
    const std::uint32_t node = place[item];
    out[item] = {tree.box[node],  tree.children[node], tree.first_child[node],
                 tree.body[node], sah_share[node],     overlap[node],
                 empty[node],     visits[node]};
  }
};

/// Keys for descending order. Values are >= 0, so their bits have the same order.
struct RankKeys {
  const float* values;
  std::uint32_t first;  ///< place of values[0]
  std::uint32_t *key, *id;
  SIM_HD void operator()(int item) const {
    key[item] = ~std::bit_cast<std::uint32_t>(values[item]);
    id[item] = first + static_cast<std::uint32_t>(item);
  }
};

}  // namespace

const float* BvhStatistics::values(NodeMetric metric) const {
  switch (metric) {
    case NodeMetric::level:
      return level_.data();
    case NodeMetric::sah_share:
      return sah_share_.data();
    case NodeMetric::sibling_overlap:
      return overlap_.data();
    case NodeMetric::empty_space:
      return empty_.data();
    case NodeMetric::visits:
      return visited_.data();
  }
  return nullptr;
}

std::vector<NodeReport> BvhStatistics::ranked(const TreeView& tree, NodeMetric metric, std::int64_t first,
                                              std::int64_t count, int from, int to) {
  from = std::max(from, 0);
  to = std::min(to, tree.levels() - 1);
  if (from > to) return {};
  const std::uint32_t begin = tree.level_begin(from);
  const auto nodes_there = static_cast<std::int64_t>(tree.level_begin(to + 1) - begin);
  first = std::clamp<std::int64_t>(first, 0, nodes_there);
  count = std::clamp<std::int64_t>(count, 0, nodes_there - first);
  if (count == 0) return {};
  for (Buffer<std::uint32_t>* numbers : {&key_, &sorted_key_, &id_, &order_})
    numbers->resize_discarding(static_cast<std::size_t>(nodes_there));
  temporary_.resize_discarding(sort_temporary_bytes<std::uint32_t>(executor_, nodes_there, 32));
  executor_.run("quality", nodes_there, RankKeys{values(metric) + begin, begin, key_.data(), id_.data()});
  sort_by_key(executor_, "quality", nodes_there, 32, key_.data(), sorted_key_.data(), id_.data(),
              order_.data(), temporary_.data(), temporary_.bytes());
  std::vector<std::uint32_t> places(static_cast<std::size_t>(count));
  executor_.copy_to_host(places.data(), order_.data() + first, places.size() * sizeof places[0]);
  return nodes(tree, places);
}

std::vector<NodeReport> BvhStatistics::nodes(const TreeView& tree, const std::vector<std::uint32_t>& places) {
  if (places.empty()) return {};
  Buffer<std::uint32_t> requested(executor_, "requested nodes");
  Buffer<GatheredNode> gathered(executor_, "gathered nodes");
  requested.upload(places);
  gathered.resize_discarding(places.size());
  executor_.run("quality", static_cast<std::int64_t>(places.size()),
                GatherNode{tree, requested.data(), sah_share_.data(), overlap_.data(), empty_.data(),
                           node_visits_.data(), gathered.data()});
  std::vector<NodeReport> reports;
  reports.reserve(places.size());
  for (const GatheredNode& node : gathered.download()) {
    NodeReport& report = reports.emplace_back();
    report.node = places[reports.size() - 1];
    report.level =
        static_cast<int>(std::ranges::upper_bound(*tree.first, report.node) - tree.first->begin()) - 1;
    report.children = node.children;
    report.first_child = node.children == 0 ? 0 : node.first_child;
    report.body = node.children == 0 ? node.body : 0;
    for (int k = 0; k < 3; ++k) {
      report.min[k] = node.box.min[k];
      report.max[k] = node.box.max[k];
    }
    report.sah_share = static_cast<double>(node.sah_share);
    report.sibling_overlap = static_cast<double>(node.overlap);
    report.empty_space = static_cast<double>(node.empty);
    report.visits = node.visits;
  }
  return reports;
}

NodeHistogram BvhStatistics::histogram(const TreeView& tree, NodeMetric metric,
                                       const NodeSelection& selection) {
  NodeHistogram result;
  const int from = std::max(selection.first_level, 0), to = std::min(selection.last_level, tree.levels() - 1);
  if (from > to) return result;
  const std::uint32_t begin = tree.level_begin(from), nodes = tree.level_begin(to + 1) - begin;
  const LoadValue load{values(metric) + begin, tree.children + begin, has_leaf_values(metric)};
  spans_.resize_discarding(reduce_scratch_size(nodes));
  ValueSpan span;
  executor_.copy_to_host(&span, reduce<ValueSpan>(executor_, "quality", nodes, load, spans_.data()),
                         sizeof span);
  if (span.count == 0) return result;
  result.count = span.count;
  result.least = span.least;
  result.greatest = span.greatest;
  // A logarithmic scale cannot start at 0; it starts at 1e-9 of the maximum.
  const double low =
      static_cast<double>(is_logarithmic(metric) ? std::max(span.least, 1e-9f * span.greatest) : span.least);
  const double high = static_cast<double>(span.greatest);
  for (std::size_t i = 0; i <= NodeHistogram::bins; ++i) {
    const double t = static_cast<double>(i) / NodeHistogram::bins;
    result.edge[i] = static_cast<float>(is_logarithmic(metric) && low > 0 ? low * std::pow(high / low, t)
                                                                          : low + t * (high - low));
  }
  result.edge.front() = span.least;
  result.edge.back() = span.greatest;

  edges_.upload(std::vector<float>(result.edge.begin(), result.edge.end()));
  counts_.resize_discarding(NodeHistogram::bins + 1);
  counts_.fill_zero();
  executor_.run("quality", nodes,
                CountValues{load, edges_.data(), selection.low, selection.high, counts_.data()});
  const std::vector<std::uint32_t> counts = counts_.download();
  std::copy_n(counts.begin(), NodeHistogram::bins, result.nodes.begin());
  result.inside = counts.back();
  return result;
}

}  // namespace collidoscope

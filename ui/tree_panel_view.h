#pragma once
// Data of the tree panel. Plain structs: the panel writes the requests, the caller writes the view.

#include <cstdint>
#include <optional>
#include <vector>

#include "sim_cuda/broad_phase/tree_quality.h"

namespace collidoscope {

struct TreeRequests {
  NodeMetric sort = NodeMetric::sibling_overlap;  ///< sort column of the table, descending
  std::int64_t first = 0;                         ///< rank of the first row
  std::optional<std::int64_t> rank;               ///< rank of the node to select; cleared by the caller
  /// Index of the selected inner node in the tree of the current state. For a leaf the body is selected
  /// instead.
  std::optional<std::uint32_t> node;
  bool query = false;    ///< draw the boxes that the selected body's query visits
  double visit = 1;      ///< number of drawn visits, from 1
  bool playing = false;  ///< advance `visit` automatically
};

/// Measurements of one state. Their size does not depend on N: values of all nodes stay on the device.
struct TreePanelView {
  static constexpr std::int64_t page = 8;              ///< rows per page of the table
  static constexpr std::int64_t max_visited = 20'000;  ///< maximum of stored visits of a query

  std::int64_t step = -1;
  double took_ms = 0;  ///< measuring time
  TreeQuality quality;
  NodeHistogram histogram;  ///< histogram of the metric that colours the shown levels; empty for the level

  std::int64_t ranked = 0;       ///< number of nodes on the shown levels
  std::int64_t first = 0;        ///< rank of rows[0]
  std::vector<NodeReport> rows;  ///< rows of the current page
  std::optional<NodeReport> node;
  std::vector<NodeReport> children;  ///< children of `node`

  std::optional<std::uint32_t> queried;  ///< id of the body with the query
  std::int64_t visits = 0;               ///< total visits of the query
  struct Visited {
    NodeReport node;
    bool met;  ///< whether the query's box overlaps it
  };
  std::vector<Visited> visited;  ///< the first visits, in order
};

}  // namespace collidoscope

#pragma once
// What the panel of the tree shows and asks for. Plain data: the requests are the panel's, the view its
// owner's.

#include <cstdint>
#include <optional>
#include <vector>

#include "sim_cuda/broad_phase/tree_quality.h"

namespace collidoscope {

struct TreeRequests {
  NodeMetric sort = NodeMetric::sibling_overlap;  ///< of the table, the greatest first
  std::int64_t first = 0;                         ///< rank of its first row
  std::optional<std::int64_t> rank;               ///< of the node to be selected; cleared by the owner
  /// Selected: its place in the tree of the current state, and of no other. Never a leaf: there the body is
  /// selected.
  std::optional<std::uint32_t> node;
  bool query = false;    ///< what the selected body's query visits is drawn
  double visit = 1;      ///< up to this one of them, from 1
  bool playing = false;  ///< it goes on by itself
};

/// Of one state. The tables are small, whatever N is: what is drawn of all nodes stays where it was measured.
struct TreePanelView {
  static constexpr std::int64_t page = 8;              ///< rows of the table
  static constexpr std::int64_t max_visited = 20'000;  ///< boxes of a query that are kept

  std::int64_t step = -1;
  double took_ms = 0;  ///< to measure
  TreeQuality quality;
  NodeHistogram histogram;  ///< of what colours the boxes, over the levels shown; none by level

  std::int64_t ranked = 0;       ///< nodes of the levels shown
  std::int64_t first = 0;        ///< rank of rows[0]
  std::vector<NodeReport> rows;  ///< a page of them
  std::optional<NodeReport> node;
  std::vector<NodeReport> children;  ///< of it

  std::optional<std::uint32_t> queried;  ///< id of the body
  std::int64_t visits = 0;               ///< of its query, all
  struct Visited {
    NodeReport node;
    bool met;  ///< the query's box overlaps it
  };
  std::vector<Visited> visited;  ///< the first of them, in order
};

}  // namespace collidoscope

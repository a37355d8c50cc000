#pragma once
// A walk over an arranged tree, of those who count what a query visits.

#include <cstdint>

#include "sim_cuda/broad_phase/tree.h"

namespace collidoscope {

/// Walks the tree from the root: visits each box whose parent overlaps `query`, children before siblings, and
/// says of each whether to go down. No stack: nodes know their parents, and siblings follow each other.
template <class Visit>
SIM_HD void walk(const TreeView& tree, const Visit& visit) {
  std::uint32_t node = 0;
  for (;;) {
    if (visit(node) && tree.children[node] > 0) {
      node = tree.first_child[node];
      continue;
    }
    for (;;) {
      if (node == 0) return;
      const std::uint32_t parent = tree.parent[node];
      if (node + 1 < tree.first_child[parent] + tree.children[parent]) break;
      node = parent;
    }
    ++node;
  }
}

}  // namespace collidoscope

#pragma once
// Traversal of a level-ordered tree, for statistics of queries.

#include <cstdint>

#include "sim_cuda/broad_phase/tree.h"

namespace collidoscope {

/// Calls visit(node) from the root, in depth-first order. Descends into the children if it returns true.
/// Stackless: nodes store their parents, and siblings are adjacent.
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

#pragma once
// A bounding volume hierarchy of a foreign program, over boxes of box_file.h.

#include <cstdint>
#include <string>
#include <vector>

#include "sim_cuda/core/aabb.h"

namespace collidoscope {

/// Nodes in the order that broad_phase/tree.h expects: leaf k is the k-th from left to right, then the inner
/// nodes, of which the root is the first.
struct GivenTree {
  std::vector<Aabb> box;                 ///< by node; that of a leaf is the box of its body
  std::vector<std::uint32_t> parent;     ///< by node; the root is its own parent
  std::vector<std::uint32_t> leaf_body;  ///< by leaf: index of its box
};

/// Nodes in any order. `no_row` as parent: the root; as leaf: an inner node.
struct TreeRows {
  static constexpr std::uint32_t no_row = ~std::uint32_t{0};
  std::vector<Aabb> box;
  std::vector<std::uint32_t> parent;  ///< row of another node
  std::vector<std::uint32_t> leaf;    ///< index of a box
};
/// Checks rows as read_tree() does. `file` begins each line of an error.
GivenTree tree_of_rows(TreeRows rows, const std::vector<Aabb>& boxes, const std::string& file);

/// Reads a NumPy array of shape (m, 8): a row for each node, in any order: min x, y, z, max x, y, z, parent,
/// box. The parent is the row of another node, -1 at the root. The box is that of a leaf, -1 at an inner
/// node. Children are ordered by row. An inner node has up to 8 children, and contains them; a leaf contains
/// its box. Each box has one leaf. Throws InputError with a line for each violation, at most 20.
GivenTree read_tree(const std::string& file, const std::vector<Aabb>& boxes);

}  // namespace collidoscope

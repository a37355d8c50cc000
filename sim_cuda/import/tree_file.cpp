#include "sim_cuda/import/tree_file.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "sim_cuda/core/error.h"
#include "sim_cuda/import/npy.h"
#include "sim_cuda/import/outwards.h"

namespace collidoscope {
namespace {

constexpr std::size_t most_tree_faults = 20, most_children = 8;
constexpr std::size_t tree_columns = 8;
constexpr std::uint32_t no_row = TreeRows::no_row;

bool box_contains(const Aabb& outer, const Aabb& inner) {
  return (outer.min.array() <= inner.min.array()).all() && (outer.max.array() >= inner.max.array()).all();
}

class TreeReader {
 public:
  TreeReader(const std::string& file, const std::vector<Aabb>& boxes) : file_(file), boxes_(boxes) {}

  GivenTree read() {
    const NpyArray array = read_npy(file_);
    if (array.shape.size() != 2 || array.shape[1] != tree_columns)
      throw InputError(
          fmt::format("{}: an array of shape {}, expected (m, 8): box, parent and leaf of each node", file_,
                      shape_text(array.shape)));
    check_count(array.shape[0]);
    read_rows(array);
    return tree();
  }
  GivenTree tree_of(TreeRows rows) {
    rows_ = std::move(rows);
    check_count(rows_.box.size());
    return tree();
  }

 private:
  GivenTree tree() {
    check_rows();
    finish();  // the checks below need valid indices
    find_root_and_leaves();
    finish();
    order_children();
    check_boxes();
    const std::vector<std::uint32_t> leaves = leaves_from_left_to_right();
    finish();
    return in_order(leaves);
  }

  void fault(const std::string& text) {
    if (faults_.size() < most_tree_faults) faults_.push_back(fmt::format("{}: {}", file_, text));
  }
  void finish() const {
    if (!faults_.empty()) throw InputError(faults_);
  }

  void check_count(std::size_t count) const {
    if (count < boxes_.size() || count > 2 * boxes_.size())
      throw InputError(fmt::format("{}: {} nodes for {} boxes, expected {} to {}", file_, count,
                                   boxes_.size(), boxes_.size(), 2 * boxes_.size()));
  }

  void read_rows(const NpyArray& array) {
    const std::size_t count = array.shape[0];
    rows_.box.resize(count);
    rows_.parent.resize(count);
    rows_.leaf.resize(count);
    array.visit([&](const auto* numbers) {
      for (std::size_t node = 0; node < count; ++node) {
        const auto at = [&](std::size_t column) {
          return numbers[array.fortran_order ? node + column * count : node * tree_columns + column];
        };
        Aabb& box = rows_.box[node];
        for (int k = 0; k < 3; ++k) {
          const auto axis = static_cast<std::size_t>(k);
          box.min[k] = rounded_outwards(at(axis), -1);
          box.max[k] = rounded_outwards(at(axis + 3), 1);
        }
        rows_.parent[node] = index(node, "parent", static_cast<double>(at(6)), count);
        rows_.leaf[node] = index(node, "box", static_cast<double>(at(7)), boxes_.size());
      }
    });
  }

  /// -1 is `no_row`.
  std::uint32_t index(std::size_t node, const char* what, double value, std::size_t count) {
    if (value == -1) return no_row;
    if (value >= 0 && value < static_cast<double>(count) && value == std::floor(value))
      return static_cast<std::uint32_t>(value);
    refuse_index(node, what, fmt::to_string(value), count);
    return no_row;
  }
  void refuse_index(std::size_t node, const char* what, const std::string& value, std::size_t count) {
    fault(fmt::format("node {}: {} {}, expected -1 or a whole number below {}", node, what, value, count));
  }

  void check_rows() {
    for (std::size_t node = 0; node < rows_.box.size(); ++node) {
      const Aabb& box = rows_.box[node];
      const bool is_of_nothing =
          box.min == Aabb::empty().min && box.max == Aabb::empty().max;  // of empty boxes in a plug-in's tree
      if (!is_of_nothing && (is_empty(box) || !box.min.allFinite() || !box.max.allFinite()))
        fault(fmt::format("node {}: a box with min above max, or not finite in single precision", node));
      const auto check = [&](const char* what, std::uint32_t value, std::size_t count) {
        if (value != no_row && value >= count)
          refuse_index(node, what, fmt::to_string(static_cast<std::int32_t>(value)), count);
      };
      check("parent", rows_.parent[node], rows_.box.size());
      check("box", rows_.leaf[node], boxes_.size());
    }
  }

  void find_root_and_leaves() {
    leaf_of_.assign(boxes_.size(), no_row);
    for (std::uint32_t node = 0; node < rows_.box.size(); ++node) {
      if (rows_.parent[node] == no_row) {
        if (root_ == no_row)
          root_ = node;
        else
          fault(fmt::format("node {}: a second root beside node {}, expected one node with parent -1", node,
                            root_));
      }
      const std::uint32_t leaf = rows_.leaf[node];
      if (leaf == no_row) continue;
      if (leaf_of_[leaf] == no_row)
        leaf_of_[leaf] = node;
      else
        fault(fmt::format("node {}: box {} is already that of node {}", node, leaf, leaf_of_[leaf]));
    }
    if (root_ == no_row) fault("no root, expected one node with parent -1");
    for (std::size_t box = 0; box < boxes_.size(); ++box)
      if (leaf_of_[box] == no_row) fault(fmt::format("no node has box {}", box));
  }

  /// Children of a node: child_[first_[node]] to child_[first_[node + 1] - 1], by row.
  void order_children() {
    first_.assign(rows_.box.size() + 1, 0);
    for (std::uint32_t node = 0; node < rows_.box.size(); ++node)
      if (node != root_) ++first_[rows_.parent[node] + 1];
    for (std::size_t node = 0; node < rows_.box.size(); ++node) first_[node + 1] += first_[node];
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    child_.resize(rows_.box.size() - 1);
    for (std::uint32_t node = 0; node < rows_.box.size(); ++node)
      if (node != root_) child_[next[rows_.parent[node]]++] = node;
  }

  void check_boxes() {
    for (std::uint32_t node = 0; node < rows_.box.size(); ++node) {
      const std::uint32_t children = first_[node + 1] - first_[node], leaf = rows_.leaf[node];
      if (leaf != no_row && children > 0) fault(fmt::format("node {}: has a box and children", node));
      if (leaf == no_row && children == 0) fault(fmt::format("node {}: neither a box nor children", node));
      if (children > most_children)
        fault(fmt::format("node {}: {} children, expected at most {}", node, children, most_children));
      if (leaf != no_row && !box_contains(rows_.box[node], boxes_[leaf]))
        fault(fmt::format("node {}: does not contain box {}", node, leaf));
      if (node != root_ && !box_contains(rows_.box[rows_.parent[node]], rows_.box[node]))
        fault(fmt::format("node {}: is not inside its parent {}", node, rows_.parent[node]));
    }
  }

  /// Nodes of the leaves, by a walk from the root. A node that is not reached is a fault.
  std::vector<std::uint32_t> leaves_from_left_to_right() {
    std::vector<std::uint32_t> leaves, stack{root_};
    std::vector<bool> reached(rows_.box.size());
    while (!stack.empty()) {
      const std::uint32_t node = stack.back();
      stack.pop_back();
      reached[node] = true;
      if (rows_.leaf[node] != no_row) leaves.push_back(node);
      for (std::uint32_t k = first_[node + 1]; k > first_[node]; --k) stack.push_back(child_[k - 1]);
    }
    for (std::size_t node = 0; node < rows_.box.size(); ++node)
      if (!reached[node])
        fault(fmt::format("node {}: cannot be reached from the root, node {}", node, root_));
    return leaves;
  }

  GivenTree in_order(const std::vector<std::uint32_t>& leaves) const {
    std::vector<std::uint32_t> number(rows_.box.size(), no_row);
    std::uint32_t next = 0;
    for (const std::uint32_t node : leaves) number[node] = next++;
    if (number[root_] == no_row) number[root_] = next++;
    for (std::uint32_t& place : number)
      if (place == no_row) place = next++;
    GivenTree tree;
    tree.box.resize(rows_.box.size());
    tree.parent.resize(rows_.box.size());
    for (const std::uint32_t node : leaves) tree.leaf_body.push_back(rows_.leaf[node]);
    for (std::uint32_t node = 0; node < rows_.box.size(); ++node) {
      const std::uint32_t leaf = rows_.leaf[node];
      tree.box[number[node]] = leaf != no_row ? boxes_[leaf] : rows_.box[node];
      tree.parent[number[node]] = number[node == root_ ? node : rows_.parent[node]];
    }
    return tree;
  }

  const std::string& file_;
  const std::vector<Aabb>& boxes_;
  std::vector<std::string> faults_;
  TreeRows rows_;
  std::uint32_t root_ = no_row;
  std::vector<std::uint32_t> leaf_of_, first_, child_;
};

}  // namespace

GivenTree tree_of_rows(TreeRows rows, const std::vector<Aabb>& boxes, const std::string& file) {
  return TreeReader(file, boxes).tree_of(std::move(rows));
}

GivenTree read_tree(const std::string& file, const std::vector<Aabb>& boxes) {
  return TreeReader(file, boxes).read();
}

}  // namespace collidoscope

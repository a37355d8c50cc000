// Tests trees of other programs: reading, checks, measures.

#include "sim_cuda/run/given_tree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "sim_cuda/core/error.h"
#include "tests/executors.h"
#include "tests/npy_file.h"
#include "tests/run_program.h"

namespace collidoscope {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// min x, y, z, max x, y, z, parent, box.
using TreeRow = std::array<double, 8>;

/// Unit cubes along x, 0.9 m apart: neighbours overlap.
std::vector<float> row_of_cubes(int count) {
  std::vector<float> numbers;
  for (int k = 0; k < count; ++k) {
    const float x = 0.9f * static_cast<float>(k);
    for (const float value : {x, 0.0f, 0.0f, x + 1, 1.0f, 1.0f}) numbers.push_back(value);
  }
  return numbers;
}

std::vector<Aabb> cubes(int count) {
  std::vector<Aabb> boxes;
  const std::vector<float> numbers = row_of_cubes(count);
  for (std::size_t k = 0; k < numbers.size(); k += 6)
    boxes.push_back({Vector3f(numbers[k], numbers[k + 1], numbers[k + 2]),
                     Vector3f(numbers[k + 3], numbers[k + 4], numbers[k + 5])});
  return boxes;
}

TreeRow leaf(int box, int parent) {
  const double x = static_cast<double>(0.9f * static_cast<float>(box));
  return {x, 0, 0, x + 1.001, 1, 1, static_cast<double>(parent), static_cast<double>(box)};
}
TreeRow inner(double from, double to, int parent) {
  return {from, 0, 0, to, 1, 1, static_cast<double>(parent), -1};
}

/// Four cubes: the root in row 2, its children in rows 0 and 6.
std::vector<TreeRow> four_cubes() {
  return {inner(0, 2, 2), leaf(1, 0), inner(0, 4, -1), leaf(0, 0), leaf(3, 6), leaf(2, 6), inner(1.7, 4, 2)};
}

class GivenTrees : public OnEachExecutor {
 protected:
  std::string file_of(const std::vector<TreeRow>& rows) {
    std::vector<double> numbers;
    for (const TreeRow& row : rows) numbers.insert(numbers.end(), row.begin(), row.end());
    return write_npy(folder_ / "t.npy", npy_bytes("{'descr': '<f8', 'fortran_order': False, 'shape': (" +
                                                      std::to_string(rows.size()) + ", 8), }",
                                                  data_of(numbers)));
  }
  TreeQuality measured(const std::vector<TreeRow>& rows, int count) {
    return quality_of(read_tree(file_of(rows), cubes(count)), options());
  }
  std::string violations(const std::vector<TreeRow>& rows, int count) {
    const std::string file = file_of(rows);
    try {
      read_tree(file, cubes(count));
    } catch (const InputError& error) {
      std::string text;
      for (const std::string& line : error.lines()) {
        EXPECT_THAT(line, testing::StartsWith(file + ": "));
        text += line.substr(file.size() + 2) + '\n';
      }
      return text;
    }
    return "";
  }
  TemporaryFolder folder_;
};
ON_EACH_EXECUTOR(GivenTrees);

TEST_P(GivenTrees, AreMeasuredAsOurs) {
  const TreeQuality quality = measured(four_cubes(), 4);
  EXPECT_EQ(quality.bodies, 4);
  EXPECT_EQ(quality.nodes, 7);
  EXPECT_EQ(quality.levels, 3);
  EXPECT_EQ(quality.pairs, 3);
  EXPECT_THAT(quality.leaves, testing::ElementsAre(0, 0, 4));
  // Each query tests the root and its two children. The cubes 0 and 3 overlap one child, the others both.
  EXPECT_NEAR(quality.visits_mean, (5 + 7 + 7 + 5) / 4.0, 1e-12);
  EXPECT_EQ(quality.visits_max, 7);
  // Bounds of the leaves are those of the boxes: the areas of 4 cubes count twice, over that of the root.
  const auto area = [](double length) { return 2 + 4 * length; };
  EXPECT_NEAR(quality.sah, (area(4) + area(2) + area(2.3) + 2 * 4 * area(1)) / area(4), 1e-5);
}

TEST_P(GivenTrees, OfOneLevelTestAllBoxes) {
  std::vector<TreeRow> rows{inner(0, 10, -1)};
  for (int k = 0; k < 8; ++k) rows.push_back(leaf(k, 0));
  const TreeQuality quality = measured(rows, 8);
  EXPECT_EQ(quality.levels, 2);
  EXPECT_EQ(quality.pairs, 7);
  EXPECT_EQ(quality.visits_mean, 9);
  const TreeQuality one = measured({{0, 0, 0, 1, 1, 1, -1, 0}}, 1);
  EXPECT_EQ(one.nodes, 1);
  EXPECT_EQ(one.pairs, 0);
}

/// A list of 1,000 inner nodes.
TEST_P(GivenTrees, CanBeDeep) {
  constexpr int count = 1001;
  std::vector<TreeRow> rows;
  for (int k = 0; k + 1 < count; ++k) rows.push_back(inner(0.8 * k, 2 * count, k - 1));
  for (int k = 0; k < count; ++k) rows.push_back(leaf(k, std::min(k, count - 2)));
  const TreeQuality quality = measured(rows, count);
  EXPECT_EQ(quality.nodes, 2 * count - 1);
  EXPECT_EQ(quality.pairs, count - 1);
}

TEST_P(GivenTrees, ViolationsNameTheirNode) {
  const auto changed = [&](std::size_t node, std::size_t column, double value) {
    std::vector<TreeRow> rows = four_cubes();
    rows[node][column] = value;
    return violations(rows, 4);
  };
  EXPECT_EQ(violations(four_cubes(), 4), "");
  EXPECT_EQ(changed(1, 7, 0), "node 3: box 0 is already that of node 1\nno node has box 1\n");
  EXPECT_EQ(changed(1, 6, -1), "node 2: a second root beside node 1, expected one node with parent -1\n");
  EXPECT_EQ(changed(2, 6, 0), "no root, expected one node with parent -1\n");
  EXPECT_EQ(changed(1, 6, 7), "node 1: parent 7, expected -1 or a whole number below 7\n");
  EXPECT_EQ(changed(1, 6, 0.5), "node 1: parent 0.5, expected -1 or a whole number below 7\n");
  EXPECT_EQ(changed(4, 7, 4), "node 4: box 4, expected -1 or a whole number below 4\n");
  EXPECT_EQ(changed(0, 3, 1.5), "node 1: is not inside its parent 0\n");
  EXPECT_EQ(changed(5, 3, 2.5), "node 5: does not contain box 2\n");
  EXPECT_EQ(changed(0, 6, 0),
            "node 0: cannot be reached from the root, node 2\n"
            "node 1: cannot be reached from the root, node 2\n"
            "node 3: cannot be reached from the root, node 2\n");
  EXPECT_THAT(changed(4, 6, 5), HasSubstr("node 5: has a box and children\n"));
  EXPECT_EQ(changed(0, 0, std::nan("")),
            "node 0: a box with min above max, or not finite in single precision\n");
  std::vector<TreeRow> rows{inner(0, 10, -1)};
  for (int k = 0; k < 9; ++k) rows.push_back(leaf(k, 0));
  EXPECT_EQ(violations(rows, 9), "node 0: 9 children, expected at most 8\n");
  EXPECT_EQ(violations({leaf(0, -1)}, 2), "1 nodes for 2 boxes, expected 2 to 4\n");
}

TEST_P(GivenTrees, AreShownBesideOurs) {
  const std::string boxes = box_file(folder_ / "b.npy", row_of_cubes(4)), tree = file_of(four_cubes());
  const std::string executor = options().executor == ExecutorKind::cuda ? "cuda" : "cpu";
  const std::vector<std::string> arguments{"bvh",         "--boxes",    boxes,       "--tree",     tree,
                                           "--repeats",   "2",          "--methods", "lbvh_ropes", "--json",
                                           folder_ / "r", "--executor", executor};
  const Outcome run = run_headless(arguments);
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("given tree"));
  const json report = json::parse(text_of(folder_ / "r"));
  ASSERT_EQ(report["trees"].size(), 2u);
  EXPECT_EQ(report["trees"][0]["method"], "given tree");
  for (const json& one : report["trees"]) EXPECT_EQ(one["pairs"], 3);

  const Outcome alone = run_headless({"bvh", "box_collider", "--tree", tree});
  EXPECT_EQ(alone.status, 2);
  EXPECT_EQ(alone.err, "--tree: needs the boxes of its leaves, expected --boxes FILE.npy\n");
}

}  // namespace
}  // namespace collidoscope

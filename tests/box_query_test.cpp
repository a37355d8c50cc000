// Tests broad phases on given boxes, in the library and through the program.

#include "sim_cuda/run/box_query.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "sim_cuda/scene/broad_phase_methods.h"
#include "tests/executors.h"
#include "tests/npy_file.h"
#include "tests/random.h"
#include "tests/run_program.h"

namespace collidoscope {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// Flat, long and large boxes, some of which coincide.
std::vector<float> mixed_boxes(int count) {
  Random random(7);
  std::vector<float> numbers;
  for (int k = 0; k < count; ++k) {
    float min[3], size[3];
    for (int axis = 0; axis < 3; ++axis) {
      min[axis] = static_cast<float>(random() % 10000) / 100;
      size[axis] = k % 50 == 0 ? 30.0f : static_cast<float>(random() % 300) / 100;
    }
    size[k % 3] = k % 7 == 0 ? 0.0f : size[k % 3];
    if (k % 11 == 10) {
      numbers.insert(numbers.end(), numbers.end() - 6, numbers.end());
      continue;
    }
    for (const float value : min) numbers.push_back(value);
    for (int axis = 0; axis < 3; ++axis) numbers.push_back(min[axis] + size[axis]);
  }
  return numbers;
}

std::vector<Aabb> boxes_of(const std::vector<float>& numbers) {
  std::vector<Aabb> boxes;
  for (std::size_t k = 0; k < numbers.size(); k += 6)
    boxes.push_back({Vector3f(numbers[k], numbers[k + 1], numbers[k + 2]),
                     Vector3f(numbers[k + 3], numbers[k + 4], numbers[k + 5])});
  return boxes;
}

BoxPairs pairs_by_definition(const std::vector<Aabb>& boxes) {
  BoxPairs pairs;
  for (std::size_t a = 0; a < boxes.size(); ++a) {
    pairs.offset.push_back(static_cast<std::uint32_t>(pairs.second.size()));
    for (std::size_t b = a + 1; b < boxes.size(); ++b)
      if (overlap(boxes[a], boxes[b])) pairs.second.push_back(static_cast<std::uint32_t>(b));
  }
  pairs.offset.push_back(static_cast<std::uint32_t>(pairs.second.size()));
  return pairs;
}

class BoxQueries : public OnEachExecutor {
 protected:
  BoxQuery query(const std::string& method, const std::vector<Aabb>& boxes) {
    RunOptions o = options();
    o.broad_phase = method;
    return {o, boxes};
  }
};
ON_EACH_EXECUTOR(BoxQueries);

TEST_P(BoxQueries, FindThePairsOfTheDefinition) {
  const std::vector<Aabb> boxes = boxes_of(mixed_boxes(700)), one = {boxes[0]},
                          same(60, boxes[0]);  // more pairs than the first capacity
  for (const std::vector<Aabb>& set : {boxes, one, same}) {
    const BoxPairs expected = pairs_by_definition(set);
    for (const std::string& method : broad_phase_names(GetParam())) {
      BoxQuery search = query(method, set);
      EXPECT_EQ(search.find(), expected) << method;
      EXPECT_EQ(search.find(), expected) << method << ", again";
      if (!search.has_tree() || set.size() == 1) continue;
      EXPECT_EQ(search.quality().pairs, std::ssize(expected.second)) << method;
      EXPECT_EQ(search.quality().bodies, std::ssize(set)) << method;
    }
  }
}

TEST_P(BoxQueries, AreTimed) {
  BoxQuery search = query("lbvh_ropes", boxes_of(mixed_boxes(300)));
  const BoxPairs before = search.find();
  const BroadPhaseTimes times = search.time(4);
  EXPECT_EQ(times.whole.size(), 4u);
  EXPECT_FALSE(times.stages.empty());
  EXPECT_EQ(search.find(), before);
}

TEST(BoxPairLists, SayWhatIsMissingAndInExcess) {
  const BoxPairs expected{{0, 2, 3, 3}, {1, 2, 2}};  // 0-1, 0-2, 1-2
  EXPECT_EQ(compare_pairs(expected, expected).missing, 0);
  const BoxPairs actual{{0, 1, 1, 2}, {2, 5}};  // 0-2, 2-5
  const PairDifference difference = compare_pairs(expected, actual, 1);
  EXPECT_EQ(difference.missing, 2);
  EXPECT_EQ(difference.excess, 1);
  using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  EXPECT_EQ(difference.missing_examples, (Pairs{{0, 1}}));
  EXPECT_EQ(difference.excess_examples, (Pairs{{2, 5}}));
}

TEST(BoxCommand, MeasuresEveryMethodOnBoxesOfAFile) {
  const TemporaryFolder folder;
  const std::vector<float> numbers = mixed_boxes(400);
  const std::string file = box_file(folder / "boxes.npy", numbers);
  const Outcome run = run_headless(
      {"bvh", "--boxes", file, "--executor", "cpu", "--repeats", "3", "--json", folder / "r.json"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  const json report = json::parse(text_of(folder / "r.json"));
  const std::size_t pairs = pairs_by_definition(boxes_of(numbers)).second.size();
  EXPECT_EQ(report["pairs"], pairs);
  EXPECT_EQ(report["reference"], "brute_force");
  EXPECT_EQ(report["methods"].size(), broad_phase_names(ExecutorKind::cpu).size());
  for (const json& method : report["methods"]) {
    EXPECT_EQ(method["agrees"], true) << method;
    EXPECT_EQ(method["pairs"], pairs);
    EXPECT_GT(method["whole_us"]["median"], 0);
    EXPECT_THAT(run.out, HasSubstr(method["method"].get<std::string>()));
  }
  EXPECT_GT(report["trees"].size(), 5u);
  for (const json& tree : report["trees"]) EXPECT_GT(tree["sah"], 0);
}

TEST(BoxCommand, TakesTheTrianglesOfAMesh) {
  const TemporaryFolder folder;
  // An open surface. The boxes of the first and the last triangle overlap; those of the others touch in a
  // corner.
  std::ofstream(folder / "mesh.obj")
      << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nv 6 5 5\nv 5 6 7\nf 1 2 3\nf 4 5 6\nf 1 2 4\n";
  const Outcome run = run_headless(
      {"bvh", "--boxes", folder / "mesh.obj", "--executor", "cpu", "--repeats", "1", "--json", "-"});
  ASSERT_EQ(run.status, 0) << run.err;
  const json report = json::parse(run.out);
  EXPECT_EQ(report["count"], 3);
  EXPECT_EQ(report["pairs"], 2);
  std::ofstream(folder / "bad.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n";
  const Outcome bad = run_headless({"bvh", "--boxes", folder / "bad.obj"});
  EXPECT_EQ(bad.status, 2);
  EXPECT_THAT(bad.err, HasSubstr("bad.obj:4:1: the face uses vertex 4, but the number of vertices is 3"));
}

TEST(BoxCommand, RefusesWhatItCannotUse) {
  const TemporaryFolder folder;
  const std::string file = box_file(folder / "boxes.npy", mixed_boxes(10)),
                    bad = box_file(folder / "bad.npy", {0, 0, 0, 1, -1, 1});
  const auto refused = [](const std::vector<std::string>& arguments) {
    const Outcome run = run_headless(arguments);
    EXPECT_EQ(run.status, 2);
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    return run.err;
  };
  EXPECT_EQ(refused({"bvh", "--boxes", bad}), bad + ": row 0: y from 0 to -1 has min above max\n");
  EXPECT_THAT(refused({"bvh", "pile", "--boxes", file}), HasSubstr("--boxes: the boxes replace the scene"));
  EXPECT_THAT(refused({"bvh", "--boxes", file, "--steps", "3"}), HasSubstr("cannot be simulated"));
  EXPECT_THAT(refused({"bvh", "--boxes", file, "--bodies", "3"}), HasSubstr("cannot be simulated"));
  EXPECT_THAT(refused({"bvh", "--boxes", folder / "none.npy"}), HasSubstr("not found"));
  EXPECT_THAT(refused({"bvh"}), HasSubstr("missing file"));
}

}  // namespace
}  // namespace collidoscope

// Tests scenes of boxes of other programs from outside: they are inspected, not simulated.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/npy_file.h"
#include "tests/random.h"
#include "tests/run_program.h"

namespace collidoscope {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class BoxScenes : public testing::Test {
 protected:
  /// Random boxes of different sides, so that the spheres within them do not have the same pairs.
  void SetUp() override {
    Uniform random{Random(11)};
    for (int box = 0; box < 300; ++box) {
      float low[3], high[3];
      for (int k = 0; k < 3; ++k) {
        low[k] = static_cast<float>(random(0, 10));
        high[k] = low[k] + static_cast<float>(random(0, k == 0 ? 4 : 0.5));
      }
      numbers_.insert(numbers_.end(), low, low + 3);
      numbers_.insert(numbers_.end(), high, high + 3);
    }
    file_ = box_file(folder_ / "boxes.npy", numbers_);
  }
  int brute_force_pairs() const {
    int pairs = 0;
    for (std::size_t a = 0; a < numbers_.size(); a += 6)
      for (std::size_t b = a + 6; b < numbers_.size(); b += 6) {
        bool overlap = true;
        for (std::size_t k = 0; k < 3; ++k)
          overlap &= numbers_[a + k] <= numbers_[b + k + 3] && numbers_[b + k] <= numbers_[a + k + 3];
        pairs += overlap;
      }
    return pairs;
  }
  static json report(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "run");
    arguments.insert(arguments.end(), {"--executor", "cpu", "--json", "-"});
    const Outcome outcome = run_headless(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return json::parse(outcome.out, nullptr, false);
  }
  /// A root with all boxes in groups of four.
  std::string tree_file() const {
    std::vector<float> rows;
    const std::size_t boxes = numbers_.size() / 6, groups = boxes / 4;
    const auto add = [&](const float* low, const float* high, float parent, float box) {
      rows.insert(rows.end(), low, low + 3);
      rows.insert(rows.end(), high, high + 3);
      rows.insert(rows.end(), {parent, box});
    };
    const float low[] = {-1, -1, -1}, high[] = {20, 20, 20};
    // A node has up to eight children, so a list of nodes leads to the groups.
    for (std::size_t group = 0; group < groups; ++group) add(low, high, static_cast<float>(group) - 1, -1);
    for (std::size_t box = 0; box < boxes; ++box)
      add(&numbers_[6 * box], &numbers_[6 * box + 3], static_cast<float>(box / 4), static_cast<float>(box));
    return write_npy(folder_ / "tree.npy", npy_bytes("{'descr': '<f4', 'fortran_order': False, 'shape': (" +
                                                         std::to_string(rows.size() / 8) + ", 8), }",
                                                     data_of(rows)));
  }

  std::vector<float> numbers_;
  std::string file_;
  TemporaryFolder folder_;
};

TEST_F(BoxScenes, HaveThePairsOfTheBoxesWithEveryMethod) {
  const int pairs = brute_force_pairs();
  std::set<std::string> hashes;
  for (const char* method :
       {"lbvh_ropes", "kd_tree", "bvh_bottom_up", "refit", "uniform_grid", "brute_force"})
    for (const char* precision : {"f32", "f64"}) {
      const json found =
          report({"--boxes", file_, "--steps", "3", "--broad-phase", method, "--precision", precision});
      EXPECT_EQ(found["pairs"]["aabb"], pairs) << method;
      EXPECT_EQ(found["pairs"]["touching"], 0);
      EXPECT_EQ(found["bodies"], 300);
      std::set<std::string> stages;
      for (const json& stage : found["stages"]) stages.insert(stage["name"]);
      EXPECT_FALSE(stages.contains("bounds") || stages.contains("solve")) << found["stages"];
      hashes.insert(found["state_hash"]);
    }
  EXPECT_LE(hashes.size(), 2u) << "one for each precision: nothing moves";
}

TEST_F(BoxScenes, AreDetectedByTheirShape) {
  EXPECT_EQ(report({file_, "--steps", "0"})["pairs"]["aabb"], brute_force_pairs());
  std::vector<float> columns(numbers_);
  std::swap(columns[0], columns[3]);  // min above max: six columns of something else
  const Outcome outcome = run_headless({"run", box_file(folder_ / "columns.npy", columns), "--steps", "0"});
  EXPECT_EQ(outcome.status, 2);
}

TEST_F(BoxScenes, HaveColumnsInTables) {
  const std::string table = folder_ / "boxes.csv";
  std::ofstream csv(table);
  csv << std::setprecision(12) << "id,xmin,ymin,zmin,xmax,ymax,zmax\n";
  for (std::size_t k = numbers_.size(); k > 0; k -= 6) {  // in descending order of ids
    csv << k / 6;
    for (std::size_t column = 0; column < 6; ++column)
      csv << ',' << static_cast<double>(numbers_[k - 6 + column]) * 1000;
    csv << '\n';
  }
  csv.close();
  const json found = report({table, "--scale", "0.001", "--steps", "0"});
  EXPECT_EQ(found["pairs"]["aabb"], brute_force_pairs());
  EXPECT_EQ(found["pairs"]["touching"], 0);
  std::ofstream(folder_ / "both.csv") << "x,y,z,xmin,ymin,zmin,xmax,ymax,zmax\n0,0,0,0,0,0,1,1,1\n";
  const Outcome both = run_headless({"run", folder_ / "both.csv", "--steps", "0"});
  EXPECT_EQ(both.status, 2);
  EXPECT_THAT(both.err, HasSubstr("leave one out with --columns"));
}

TEST_F(BoxScenes, ShowATreeOfAnotherProgram) {
  const std::string out = folder_ / "pictures";
  const Outcome outcome =
      run_headless({"capture", "--boxes", file_, "--tree", tree_file(), "--executor", "cpu", "--out", out});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("bodies 300  boxes drawn 375  touching 0")) << "75 nodes and 300 leaves";
  const Outcome ours = run_headless({"capture", "--boxes", file_, "--executor", "cpu", "--out", out});
  EXPECT_THAT(ours.out, HasSubstr("boxes drawn 599"));
}

TEST_F(BoxScenes, AreKeptInSceneFilesAndSnapshots) {
  const std::string scene = folder_ / "scene.json", snapshot = folder_ / "boxes.snapshot";
  const json first = report(
      {"--boxes", file_, "--tree", tree_file(), "--steps", "1", "--write-scene", scene, "--save", snapshot});
  EXPECT_THAT(text_of(scene), HasSubstr("\"tree\": \"tree.npy\""));
  EXPECT_EQ(report({scene, "--steps", "1"})["pairs"], first["pairs"]);
  EXPECT_EQ(report({"--load", snapshot, "--steps", "0"})["pairs"], first["pairs"]);
}

TEST_F(BoxScenes, WrongFilesAreBadInput) {
  const auto fault = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "run");
    const Outcome outcome = run_headless(arguments);
    EXPECT_EQ(outcome.status, 2);
    return outcome.err;
  };
  EXPECT_THAT(fault({"--boxes", folder_ / "none.npy"}), HasSubstr("none.npy"));
  EXPECT_THAT(fault({"--tree", tree_file(), file_}), HasSubstr("--tree: needs the boxes of its leaves"));
  EXPECT_THAT(fault({"--boxes", file_, "box_collider"}), HasSubstr("--boxes: the boxes replace the scene"));
  std::vector<float> far(numbers_);
  far[3] = 1e20f;
  EXPECT_THAT(fault({"--boxes", box_file(folder_ / "far.npy", far)}), HasSubstr("box 0 is beyond 1e+09 m"));
  std::ofstream(folder_ / "mixed.json")
      << R"({"format": "collidoscope-scene", "version": 1, "bodies": [{"shape": "sphere", "radius": 1, "position": [0, 0, 0]}],
             "body_files": [{"path": "boxes.npy", "boxes": true}]})";
  EXPECT_THAT(fault({folder_ / "mixed.json"}), HasSubstr("must be the only bodies of the scene"));
  std::ofstream(folder_ / "scaled.json")
      << R"({"format": "collidoscope-scene", "version": 1, "body_files": [{"path": "boxes.npy", "boxes": true, "scale": 2}]})";
  EXPECT_THAT(fault({folder_ / "scaled.json"}), HasSubstr("boxes without columns, expected no scale"));
}

TEST(Series, ArePicturesOfTheirFrames) {
  const TemporaryFolder folder;
  std::vector<std::string> arguments{"capture", "--executor", "cpu",         "--size",
                                     "320x200", "--out",      folder / "out"};
  for (const int number : {10, 9}) {
    const std::string file = folder / ("f" + std::to_string(number) + ".csv");
    std::ofstream(file) << "x,y,z,radius\n0,0,0,1\n" << (number == 10 ? "1.5" : "9") << ",0,0,1\n";
    arguments.push_back(file);
  }
  const Outcome outcome = run_headless(arguments);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("state 0  bodies 2  boxes drawn 0  touching 0"));
  EXPECT_THAT(outcome.out, HasSubstr("state 1  bodies 2  boxes drawn 0  touching 1"));
  arguments.insert(arguments.end(), {"--states", "2"});
  const Outcome beyond = run_headless(arguments);
  EXPECT_EQ(beyond.status, 2);
  EXPECT_THAT(beyond.err, HasSubstr("--states: 2 is after the last frame, 1"));
}

}  // namespace
}  // namespace collidoscope

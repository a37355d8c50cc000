// Tests files of other programs from outside: a script writes them with NumPy, and the program reads them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/run_program.h"

namespace collidoscope {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// The bodies of the script, by the same formulas.
struct ScriptBody {
  double x[3], r, v[3];
};
std::vector<ScriptBody> script_bodies() {
  std::vector<ScriptBody> bodies;
  for (int i = 0; i < 500; ++i)
    bodies.push_back({{(i * 37 % 101) * 0.1, (i * 61 % 103) * 0.1, (i * 17 % 107) * 0.1},
                      0.1 + (i % 7) * 0.05,
                      {(i % 5) * 0.25, (i % 3) * 0.5, -(i % 2) * 1.0}});
  return bodies;
}

/// Pairs of boxes that overlap, by comparing all. Boxes of the program are rounded outwards to floats, so
/// boxes that touch up to rounding overlap.
int brute_force_pairs(const std::vector<ScriptBody>& bodies) {
  int pairs = 0;
  for (std::size_t a = 0; a < bodies.size(); ++a)
    for (std::size_t b = a + 1; b < bodies.size(); ++b) {
      bool overlap = true;
      for (int k = 0; k < 3; ++k)
        overlap &= std::abs(bodies[a].x[k] - bodies[b].x[k]) <= bodies[a].r + bodies[b].r + 1e-6;
      pairs += overlap;
    }
  return pairs;
}

class ForeignFiles : public testing::Test {
 protected:
  /// Writes all files once.
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    has_numpy_ = run_program("/usr/bin/python3", {"-c", "import numpy"}).status == 0;
    if (!has_numpy_) return;
    const Outcome script =
        run_program("/usr/bin/python3", {project_file("tests/write_foreign_files.py"), folder_->path()});
    ASSERT_EQ(script.status, 0) << script.err;
  }
  static void TearDownTestSuite() { delete folder_; }
  static std::string file(const std::string& name) { return *folder_ / name; }

  void SetUp() override {
    if (!has_numpy_) GTEST_SKIP() << "python3-numpy is not installed";
  }

  static TemporaryFolder* folder_;
  static bool has_numpy_;
};
TemporaryFolder* ForeignFiles::folder_ = nullptr;
bool ForeignFiles::has_numpy_ = false;

TEST_F(ForeignFiles, HaveTheSameBodiesInEveryFormat) {
  const std::vector<ScriptBody> bodies = script_bodies();
  const int pairs = brute_force_pairs(bodies);
  for (const char* name : {"c_order.npy", "fortran_order.npy", "big_endian.npy", "arrays.npz", "columns.npz",
                           "savetxt.txt", "tabs.tsv", "shuffled.csv", "semicolons.csv", "dump.lammpstrj",
                           "extended.xyz", "little.ply", "big.ply", "text.ply"}) {
    SCOPED_TRACE(name);
    std::vector<std::string> arguments{"run",         file(name), "--steps",       "0",
                                       "--precision", "f64",      "--executor",    "cpu",
                                       "--json",      "-",        "--dump-bodies", file("bodies.csv")};
    if (std::string(name) == "dump.lammpstrj") arguments.insert(arguments.end(), {"--frame", "1"});
    const Outcome run = run_headless(arguments);
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_THAT(run.err, HasSubstr("500 bodies"));
    const json report = json::parse(run.out);
    EXPECT_EQ(report["pairs"]["aabb"], pairs);
    std::istringstream rows(text_of(file("bodies.csv")));
    std::string row;
    std::getline(rows, row);
    EXPECT_EQ(row, "id,radius,mass,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz");
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      ASSERT_TRUE(std::getline(rows, row)) << k;
      double value[13];
      std::istringstream numbers(row);
      for (double& number : value) {
        std::string field;
        std::getline(numbers, field, ',');
        number = std::stod(field);
      }
      const ScriptBody& body = bodies[k];
      ASSERT_EQ(value[0], static_cast<double>(k));
      ASSERT_EQ(value[1], body.r) << k;
      for (int axis = 0; axis < 3; ++axis) {
        ASSERT_EQ(value[3 + axis], body.x[axis]) << k;
        ASSERT_EQ(value[10 + axis], body.v[axis]) << k;
      }
    }
  }
}

TEST_F(ForeignFiles, SayWhatIsNotTaken) {
  const auto notes = [&](const std::vector<std::string>& arguments) {
    std::vector<std::string> all{"run", "--steps", "0"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const Outcome run = run_headless(all);
    EXPECT_EQ(run.status, 0) << run.err;
    return run.err;
  };
  EXPECT_THAT(notes({file("shuffled.csv")}), HasSubstr("columns not used: name\n"));
  EXPECT_THAT(notes({file("arrays.npz")}), HasSubstr("array not used: time (9,), expected 500 rows"));
  EXPECT_THAT(notes({file("dump.lammpstrj")}), HasSubstr("frame 0 of 3"));
  EXPECT_THAT(notes({file("dump.lammpstrj")}), HasSubstr("columns not used: type\n"));
}

TEST_F(ForeignFiles, KeepTheirColumnsInASceneFile) {
  const auto hash_of = [](const std::vector<std::string>& arguments) -> std::string {
    std::vector<std::string> all{"run", "--steps", "2", "--executor", "cpu", "--json", "-"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const Outcome run = run_headless(all);
    EXPECT_EQ(run.status, 0) << run.err;
    return run.status == 0 ? json::parse(run.out)["state_hash"] : json("");
  };
  const std::string written = hash_of({file("shuffled.csv"), "--columns", "vz=none", "--scale", "0.5",
                                       "--gravity", "0,0,-1", "--write-scene", file("scene.json")});
  EXPECT_EQ(hash_of({file("scene.json")}), written);
  EXPECT_NE(hash_of({file("shuffled.csv")}), written);
  std::filesystem::create_directory(file("below"));
  const Outcome refused =
      run_headless({"run", file("shuffled.csv"), "--steps", "0", "--write-scene", file("below/scene.json")});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("--write-scene: shuffled.csv is not in the folder of the scene"));
}

TEST_F(ForeignFiles, RefuseWhatIsUnsafe) {
  const auto refusal = [&](const std::string& name) {
    const Outcome run = run_headless({"run", file(name), "--steps", "0"});
    EXPECT_EQ(run.status, 2) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    return run.err;
  };
  EXPECT_THAT(refusal("objects.npy"), HasSubstr("an array of objects, which can contain code"));
  EXPECT_THAT(refusal("bomb.npz"), HasSubstr("position has 2147483647 bytes, compressed to"));
}

}  // namespace
}  // namespace collidoscope

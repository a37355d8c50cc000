// Tests bodies of foreign files within scenes: ids, materials, removal, faults, snapshots.

#include "sim_cuda/scene/body_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "sim_cuda/changes/changes.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/import/body_table.h"
#include "sim_cuda/scene/body_count.h"
#include "sim_cuda/scene/scene_file.h"
#include "sim_cuda/snapshot/snapshot.h"
#include "tests/test_files.h"

namespace collidoscope {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class BodyFiles : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(folder_ / "four.csv")
        << "x,y,z,r,vx\n0,0,0,0.5,1\n2,0,0,0.5,0\n4,0,0,0.25,0\n6,0,0,0.5,-1\n";
    std::ofstream(folder_ / "points.xyz") << "2\n\nH 0 5 0\nH 1 5 0\n";
  }
  Scene parse(const std::string& members) {
    return parse_scene("{\"format\": \"collidoscope-scene\", \"version\": 1, " + members + "}", "s.json",
                       folder_.path());
  }
  std::string refusal(const std::string& members) {
    try {
      initial_bodies(parse(members));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  static std::vector<double> places(const Scene& scene) {
    std::vector<double> x;
    for (const Vector3d& position : initial_bodies(scene).position) x.push_back(position.x());
    return x;
  }
  static constexpr const char* mixed =
      R"("materials": {"default": {}, "heavy": {"density": 8000}},
         "bodies": [{"position": [-3, 0, 0]}],
         "body_files": [{"path": "four.csv", "material": "heavy"}, {"path": "points.xyz", "radius": 0.1}],
         "extra_bodies": [{"position": [9, 9, 9]}])";
  TemporaryFolder folder_;
};

TEST_F(BodyFiles, FollowListedBodiesAndComeBeforeAddedOnes) {
  const Scene scene = parse(mixed);
  const InitialBodies bodies = initial_bodies(scene);
  EXPECT_EQ(bodies_of(scene), 8);
  EXPECT_THAT(places(scene), ElementsAre(-3, 0, 2, 4, 6, 0, 1, 9));
  EXPECT_THAT(bodies.radius, ElementsAre(1, 0.5, 0.5, 0.25, 0.5, 0.1, 0.1, 1));
  EXPECT_THAT(bodies.material, ElementsAre(0, 1, 1, 1, 1, 0, 0, 0));
  EXPECT_EQ(bodies.velocity[0], Vector3d(0, 0, 0));
  EXPECT_EQ(bodies.velocity[4], Vector3d(-1, 0, 0));
  EXPECT_NEAR(bodies.mass[1] / bodies.mass[5], 8 * 125, 1e-9);
}

TEST_F(BodyFiles, AreWrittenAsTheyWereRead) {
  const Scene scene = parse(mixed), again = parse_scene(write_scene(scene), "s.json", folder_.path());
  EXPECT_EQ(write_scene(again), write_scene(scene));
  EXPECT_EQ(places(again), places(scene));
  const Scene all = parse(
      R"("body_files": [{"path": "four.csv", "columns": "radius=none", "scale": 0.5, "radius": 0.3, "excluded": [0, 2]}])");
  EXPECT_EQ(write_scene(parse_scene(write_scene(all), "s.json", folder_.path())), write_scene(all));
  EXPECT_THAT(places(all), ElementsAre(1, 3));
}

TEST_F(BodyFiles, LoseTheBodiesThatAChangeRemoves) {
  const Scene before = parse(mixed);
  Scene scene = before;
  Change change;
  change.remove = {2, 5, 7};
  RunOptions options;
  const BodyIdMap ids = apply_change(change, scene, options);
  EXPECT_THAT(ids, ElementsAre(0, 1, no_body, 2, 3, no_body, 4, no_body));
  EXPECT_THAT(places(scene), ElementsAre(-3, 0, 4, 6, 1));
  EXPECT_THAT(scene.body_files[0].excluded, ElementsAre(1));
  EXPECT_THAT(scene.body_files[1].excluded, ElementsAre(0));
  const std::optional<Change> merged = merged_change(before, scene, {});
  ASSERT_TRUE(merged);
  EXPECT_THAT(merged->remove, testing::UnorderedElementsAre(2, 5, 7));
  EXPECT_FALSE(requires_restart(before, scene));
}

TEST_F(BodyFiles, ContinueInASnapshot) {
  World world(parse(mixed), RunOptions{});
  world.step(3);
  const Snapshot snapshot = snapshot_of(world);
  std::ofstream file(folder_ / "s.snapshot", std::ios::binary);
  write_snapshot(snapshot, [&](std::string_view bytes) { file << bytes; });
  file.close();
  const Snapshot read = read_snapshot(folder_ / "s.snapshot");
  World other = world_from(read, read.scene, RunOptions{});
  world.step(3);
  other.step(3);
  EXPECT_EQ(other.state_hash(), world.state_hash());
  // Another file of the same name.
  std::ofstream(folder_ / "four.csv") << "x,y,z,r\n0,0,0,1\n2,0,0,1\n4,0,0,1\n6,0,0,1\n";
  const Snapshot changed = read_snapshot(folder_ / "s.snapshot");
  EXPECT_THROW(world_from(changed, changed.scene, RunOptions{}), InputError);
}

TEST_F(BodyFiles, FaultsAreLocated) {
  const auto of = [&](const std::string& file) { return refusal("\n\"body_files\": [" + file + "]"); };
  EXPECT_THAT(of(R"({"path": "points.xyz"})"),
              HasSubstr("radius: must be given, since the file has no radii"));
  EXPECT_THAT(of(R"({"path": "four.csv", "radius": 1})"),
              HasSubstr("s.json:2:47: body_files[0].radius: must not be given, since the file has radii"));
  EXPECT_THAT(of(R"({"path": "none.csv"})"),
              HasSubstr("s.json:2:25: " + (folder_ / "none.csv").string() + ": not found"));
  EXPECT_THAT(of(R"({"path": "../four.csv"})"), HasSubstr("expected a relative path without .."));
  EXPECT_THAT(of(R"({"path": "/etc/passwd"})"), HasSubstr("expected a relative path without .."));
  EXPECT_THAT(of(R"({"columns": "x=1"})"), HasSubstr("s.json:2:16: a file of bodies must have a \"path\""));
  EXPECT_THAT(of(R"({"path": "four.csv", "columns": "speed=1"})"), HasSubstr("unknown quantity speed"));
  EXPECT_THAT(of(R"({"path": "four.csv", "excluded": [4]})"),
              HasSubstr("must be the index of one of its 4 bodies, from 0, in ascending order"));
  EXPECT_THAT(of(R"({"path": "four.csv", "scale": 0})"), HasSubstr("body_files[0].scale: must lie in"));
  EXPECT_THAT(of(R"({"path": "four.csv", "Scale": 1})"), HasSubstr("Scale"));
  std::filesystem::create_symlink("/etc/hostname", folder_ / "link.csv");
  EXPECT_THAT(of(R"({"path": "link.csv"})"), HasSubstr("a link that leaves the folder of the scene"));
}

}  // namespace
}  // namespace collidoscope

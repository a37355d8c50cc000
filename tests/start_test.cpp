// Tests runs that start at a snapshot: `--load` and `--save` of the program.

#include <gmock/gmock.h>

#include <fstream>

#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/snapshot/snapshot.h"
#include "tests/run_program.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

TEST(SnapshotOfARun, RefusesFlagsThatAskForOtherBodies) {
  const TemporaryFolder folder;
  const std::string file = folder / "s";
  ASSERT_EQ(run_headless({"run", "box_collider", "--bodies", "20", "--steps", "2", "--save", file}).status,
            0);
  for (const auto& [flag, value] :
       {std::pair{"--seed", "5"}, {"--variant", "equal"}, {"--spawn", "centres"}}) {
    const Outcome outcome = run_headless({"run", "--load", file, "--steps", "1", flag, value});
    EXPECT_EQ(outcome.status, 2) << flag;
    EXPECT_EQ(outcome.err, std::string(flag) + ": " + file + " has different bodies; remove " + flag +
                               ", or give SCENE instead of --load\n");
  }
  for (const auto& [flag, value] : {std::pair{"--seed", "1"}, {"--bodies", "25"}, {"--time-step", "1/100"}}) {
    const Outcome outcome = run_headless({"run", "--load", file, "--steps", "1", flag, value});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
  }
}

TEST(SnapshotOfARun, OfAnotherPhysicsVersionIsNoted) {
  const TemporaryFolder folder;
  const std::string file = folder / "s", saved = folder / "t";
  RunOptions o;
  o.executor = ExecutorKind::cpu;
  World world(box_collider(20), o);
  Snapshot snapshot = snapshot_of(world);
  const auto write = [&] {
    std::ofstream out(file, std::ios::binary);
    write_snapshot(snapshot, [&](std::string_view bytes) { out << bytes; });
  };
  write();
  EXPECT_EQ(run_headless({"run", "--load", file, "--steps", "1"}).err, "");
  snapshot.physics_version = physics_version + 1;
  write();
  const Outcome outcome = run_headless({"run", "--load", file, "--steps", "1", "--save", saved});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.err, "note: " + file + " was written by physics version " +
                             std::to_string(physics_version + 1) + "; this program has version " +
                             std::to_string(physics_version) + ", so the run continues differently\n");
  EXPECT_EQ(read_snapshot(saved).physics_version, physics_version);
}

TEST(SnapshotOfARun, SavedLoadedAndSavedAgain) {
  const TemporaryFolder folder;
  const std::string file = folder / "s", json = folder / "j";
  const auto hash_line = [&] {
    const std::string text = text_of(json);
    return text.substr(text.find("state_hash"), 32);
  };
  const std::vector<std::string> scene{"run",     "box_collider", "--bodies", "300", "--solver", "soft_step",
                                       "--steps", "20",           "--json",   json,  "--save",   file};
  EXPECT_EQ(run_headless(scene).status, 0);
  for (int k = 0; k < 2; ++k) {  // in place
    const Outcome outcome =
        run_headless({"run", "--load", file, "--steps", "10", "--save", file, "--json", json});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
  }
  const std::string in_parts = hash_line();
  std::vector<std::string> whole = scene;
  whole[7] = "40";
  EXPECT_EQ(run_headless(whole).status, 0);
  EXPECT_EQ(hash_line(), in_parts);

  const Outcome edited = run_headless({"run", "--load", file, "--steps", "1", "--gravity", "0,0,0"});
  EXPECT_EQ(edited.status, 0) << edited.err;
  const Outcome early = run_headless({"capture", "--load", file, "--states", "10", "--out", folder / "out"});
  EXPECT_EQ(early.status, 2);
  EXPECT_EQ(early.err, "--states: 10 is before the first state; expected at least 40\n");
  const Outcome two = run_headless({"run", "box_collider", "--load", file});
  EXPECT_EQ(two.status, 2);
  EXPECT_EQ(two.err, "--load: the snapshot contains its scene; remove box_collider\n");
  const Outcome lost = run_headless({"run", "--load", file, "--steps", "1", "--json", file});
  EXPECT_EQ(lost.status, 2);
  EXPECT_THAT(lost.err, testing::HasSubstr("is also the file of --json"));
}

}  // namespace
}  // namespace collidoscope

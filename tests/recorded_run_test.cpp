// Tests runs that are written to a recording from memory, and read from one with all their states.

#include "sim_cuda/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <map>

#include "sim_cuda/changes/changes_file.h"
#include "sim_cuda/core/cancellation.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/recording/recorder.h"
#include "sim_cuda/recording/replay.h"
#include "tests/executors.h"
#include "tests/scenes.h"
#include "viewer/session/live_world.h"

namespace collidoscope {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Scene rolling_scene() {
  Scene scene = box_collider(60);
  scene.box->max = Vector3d(20, 20, 20);
  scene.generators[0].radius_max = 3;
  scene.generators[0].speed_max = 4;
  scene.generators[0].spawn = Spawn::inside;
  scene.materials[0].friction = 0.4;
  scene.physics.solver = Solver::soft_step;
  scene.physics.sleep = Sleep{};
  return scene;
}

/// Changes of every kind, two of them at one state.
const char* const changes_of_run = R"({"format": "collidoscope-changes", "version": 1, "changes": [
  {"step": 4, "bodies": 70}, {"step": 8, "add": [{"radius": 2, "position": [12, 12, 20], "velocity": [0, 1, -30]}]},
  {"step": 10, "freeze": [3]}, {"step": 12, "remove": [0, 41]}, {"step": 12, "restitution": 0.3},
  {"step": 20, "blocks": 3, "threads": 32}, {"step": 24, "solver": "jacobi_split"}, {"step": 30, "precision": "f64"}]})";

class RecordedRuns : public OnEachExecutor {
 protected:
  static constexpr std::int64_t steps = 60;
  using Hashes = std::map<std::int64_t, std::uint64_t>;

  /// Steps to a state, and remembers the hashes after the changes.
  void advance(LiveWorld& live, std::int64_t to, Hashes& hashes) const {
    const ChangeList list = parse_changes(changes_of_run, "changes", rolling_scene(), options(), 0);
    hashes[live.world().steps()] = live.state_hash();
    while (live.world().steps() < to) {
      ASSERT_TRUE(live.step(true));
      for (const Change& change : list.changes)
        if (change.step == live.world().steps()) live.apply(change);
      hashes[live.world().steps()] = live.state_hash();
    }
  }
  std::string write(LiveWorld& live) const {
    const std::string file = folder_ / "run.recording";
    write_run(file, live.timeline(), live.changes(), live.world());
    return file;
  }
  static LiveWorld opened(const std::string& file, const RunOptions& options) {
    const RecordingReader recording(file);
    const Snapshot snapshot = last_keyframe(recording);
    LiveWorld live(world_from(snapshot, snapshot.scene, options));
    live.take_recording(read_run(recording));
    return live;
  }
  static void expect_all_states(LiveWorld& live, const Hashes& hashes) {
    for (const std::int64_t step : {60, 0, 3, 4, 5, 11, 12, 13, 29, 30, 31, 59}) {
      live.go_to(step);
      EXPECT_EQ(live.state_hash(), hashes.at(step)) << step;
    }
  }
  TemporaryFolder folder_;
};
ON_EACH_EXECUTOR(RecordedRuns);

TEST_P(RecordedRuns, AreReplayedAndReachEveryStateAgain) {
  LiveWorld live(rolling_scene(), options());
  Hashes hashes;
  advance(live, steps, hashes);
  const std::string file = write(live);
  EXPECT_EQ(folder_.files(), 1u) << "no partial file";
  const RecordingReader recording(file);
  EXPECT_TRUE(recording.ended());
  RunOptions other = on_cpu(1);
  other.lane_order = LaneOrder::strided;
  other.shape = {3, 32};
  const ReplayResult result = replay(recording, other, [](std::int64_t) {});
  EXPECT_FALSE(result.difference) << *result.difference;
  EXPECT_EQ(result.states, steps);
  EXPECT_EQ(result.changes, 7) << "without the launch shape";

  LiveWorld again = opened(file, options());
  EXPECT_EQ(again.world().steps(), steps);
  EXPECT_EQ(again.timeline().first(), 0);
  EXPECT_EQ(again.timeline().last(), steps);
  ASSERT_EQ(again.marks().size(), 7u);
  for (std::size_t k = 0; k < 7; ++k) EXPECT_EQ(again.marks()[k].text, live.marks()[k].text);
  expect_all_states(again, hashes);
  // From an earlier state through the known states, over changes, and on as the run itself.
  again.go_to(2);
  while (again.world().steps() < steps) {
    ASSERT_TRUE(again.step(true));
    ASSERT_EQ(again.state_hash(), hashes.at(again.world().steps())) << again.world().steps();
  }
  EXPECT_EQ(again.history().size(), static_cast<std::size_t>(steps - 2)) << "the passed states";
  for (int k = 0; k < 5; ++k) {
    ASSERT_TRUE(again.step(false));
    ASSERT_TRUE(live.step(false));
    EXPECT_EQ(again.state_hash(), live.state_hash());
  }
}

TEST_P(RecordedRuns, CanBeReadFromAFileOfARecorder) {
  const std::string file = folder_ / "run.recording";
  Hashes hashes;
  {
    LiveWorld live(rolling_scene(), options());
    Recorder recorder(file);
    recorder.begin(live.world());
    const ChangeList list = parse_changes(changes_of_run, "changes", rolling_scene(), options(), 0);
    hashes[0] = live.state_hash();
    while (live.world().steps() < steps) {
      live.step(false);
      recorder.record_step(live.world());
      for (const Change& change : list.changes) {
        if (change.step != live.world().steps()) continue;
        const Scene before = live.world().scene();
        live.apply(change);
        recorder.record_change(live.world(), change, before);
      }
      hashes[live.world().steps()] = live.state_hash();
    }
    // It does not end, as after a kill.
  }
  LiveWorld again = opened(file, options());
  EXPECT_EQ(again.world().steps(), 30) << "the last keyframe";
  again.go_to(again.timeline().last());
  EXPECT_EQ(again.state_hash(), hashes.at(again.world().steps()));
}

TEST_P(RecordedRuns, BeginALongerRecording) {
  LiveWorld live(rolling_scene(), options());
  Hashes hashes;
  advance(live, 20, hashes);
  LiveWorld again = opened(write(live), options());
  advance(again, steps, hashes);
  const std::string file = write(again);
  expect_all_states(again, hashes);
  const ReplayResult result = replay(RecordingReader(file), on_cpu(2), [](std::int64_t) {});
  EXPECT_FALSE(result.difference) << *result.difference;
  EXPECT_EQ(result.states, steps);
}

TEST_P(RecordedRuns, AreNotWrittenHalf) {
  Cancellation cancellation;
  RunOptions cancellable = options();
  cancellable.cancellation = &cancellation;
  LiveWorld live(rolling_scene(), cancellable);
  live.step(false);
  cancellation.request_between_steps();
  EXPECT_THROW(write(live), Cancelled);
  cancellation.clear();
  EXPECT_EQ(folder_.files(), 0u);
  EXPECT_THAT([&] { write_run(folder_ / "none" / "run.recording", live.timeline(), {}, live.world()); },
              testing::ThrowsMessage<FileWriteError>(HasSubstr("run.recording")));
  EXPECT_THROW(write_run("/dev/full", live.timeline(), {}, live.world()), FileWriteError);
  std::filesystem::create_directory(folder_ / "run.recording");
  std::filesystem::create_directory(folder_ / "run.recording" / "not empty");
  EXPECT_THROW(write(live), MachineError);
  EXPECT_EQ(folder_.files(), 1u);
}

/// Guards are no part of the state, but bodies that they froze are.
TEST_P(RecordedRuns, KeepWhatGuardsFroze) {
  Scene scene = rolling_scene();
  scene.physics.guards = ValidationSettings{.speed = 9};
  scene.physics.guards->on_failure = OnFailure::freeze;
  LiveWorld live(scene, options());
  const auto set_guards = [&](std::optional<OnFailure> guards) {
    Settings request = live.settings();
    request.guards = guards;
    live.apply(request);
  };
  const auto frozen = [&] { return live.world().validation().frozen().size(); };
  set_guards(std::nullopt);
  Hashes hashes;
  const auto go_on = [&](std::int64_t to) {
    while (live.world().steps() < to) {
      ASSERT_TRUE(live.step(true));
      hashes[live.world().steps()] = live.state_hash();
    }
  };
  go_on(20);
  ASSERT_EQ(frozen(), 0u);
  set_guards(OnFailure::freeze);
  go_on(40);
  ASSERT_GT(frozen(), 0u) << "bodies are faster than 9 m/s";
  for (const std::int64_t step : {40, 10, 21, 22, 30, 19}) {
    live.go_to(step);
    EXPECT_EQ(live.state_hash(), hashes.at(step)) << step;
  }
  const ReplayResult result = replay(RecordingReader(write(live)), on_cpu(1), [](std::int64_t) {});
  EXPECT_FALSE(result.difference) << *result.difference;
  EXPECT_EQ(result.states, 40);

  // With guards on, a step from an earlier state can freeze a body that was free: a branch.
  live.go_to(10);
  const std::uint64_t before = hashes.at(11);
  ASSERT_TRUE(live.step(true));
  ASSERT_NE(live.state_hash(), before);
  EXPECT_GT(frozen(), 0u);
  EXPECT_EQ(live.timeline().last(), 11);
  ASSERT_TRUE(live.other_run());
  EXPECT_EQ(live.other_run()->last, 40);
}

}  // namespace
}  // namespace collidoscope

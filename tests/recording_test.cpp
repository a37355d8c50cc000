// Tests recordings: every state is reached again however the run is simulated, and files that are cut off,
// damaged or foreign.

#include <gmock/gmock.h>

#include <algorithm>
#include <cstring>
#include <fstream>

#include "headless/change_replay.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/fingerprint.h"
#include "sim_cuda/recording/recorded_run.h"
#include "sim_cuda/recording/recorder.h"
#include "sim_cuda/recording/recording_chunks.h"
#include "sim_cuda/recording/replay.h"
#include "sim_cuda/run/run_state.h"
#include "tests/executors.h"
#include "tests/fuzz/reader_checks.h"
#include "tests/run_program.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// Changes of every kind.
const char* const recorded_changes = R"({"format": "collidoscope-changes", "version": 1, "changes": [
  {"step": 4, "bodies": 70}, {"step": 6, "blocks": 3, "threads": 32, "broad_phase": "uniform_grid"},
  {"step": 8, "add": [{"radius": 2, "position": [12, 12, 20], "velocity": [0, 1, -30]}]},
  {"step": 10, "freeze": [3]}, {"step": 12, "remove": [0, 41]}, {"step": 14, "solver": "impulse", "effects": ["gravity", "rotation"]},
  {"step": 16, "solver": "jacobi_split", "effects": "auto"}, {"step": 18, "solver": "soft_step", "substeps": 6},
  {"step": 20, "restitution": 0.3, "precision": "f64"}, {"step": 24, "precision": "f32"}]})";
constexpr std::int64_t recorded_steps = 60;

Scene recorded_scene() {
  Scene scene = box_collider(60);
  scene.box->max = Vector3d(20, 20, 20);
  scene.generators[0].radius_max = 3;
  scene.generators[0].speed_max = 4;
  scene.generators[0].spawn = Spawn::inside;
  scene.materials[0].friction = 0.4;
  scene.materials[0].rolling_resistance = 0.05;
  scene.physics.solver = Solver::soft_step;
  scene.physics.sleep = Sleep{};
  return scene;
}

/// Records the scene with the changes into `file`.
void record(const std::filesystem::path& file, RunOptions options, bool ends = true) {
  const TemporaryFolder folder;
  std::ofstream(folder / "changes.json") << recorded_changes;
  Start start{recorded_scene(), {}};
  ChangeReplay changes(folder / "changes.json", start, options);
  World world = start.world(options);
  Recorder recorder(file);
  recorder.begin(world);
  while (world.steps() < recorded_steps) {
    world.step();
    recorder.record_step(world);
    changes.make_due(world, &recorder);
  }
  if (ends) recorder.end(world);
}

ReplayResult replayed(const std::filesystem::path& file, const RunOptions& options) {
  const RecordingReader recording(file);
  return replay(recording, options, [](std::int64_t) {});
}

/// Offsets of all chunks, with the end of the file.
std::vector<std::size_t> chunk_begins(const std::string& bytes) {
  std::vector<std::size_t> begins;
  for (std::size_t at = 32; at <= bytes.size();) {
    begins.push_back(at);
    if (at == bytes.size()) break;
    std::uint64_t size = 0;
    std::memcpy(&size, bytes.data() + at + 8, sizeof size);
    at += 24 + (size + 7) / 8 * 8 + 8;
  }
  return begins;
}

void write(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

std::string refusal(const std::filesystem::path& file) {
  try {
    replayed(file, on_cpu());
  } catch (const InputError& error) {
    EXPECT_EQ(error.lines().size(), 1u);
    return error.lines()[0];
  }
  return "";
}

class Recordings : public OnEachExecutor {};
ON_EACH_EXECUTOR(Recordings);

TEST_P(Recordings, AreReachedAgainHoweverTheRunIsSimulated) {
  const TemporaryFolder folder;
  record(folder / "run", options());
  const RecordingReader recording(folder / "run");
  EXPECT_TRUE(recording.ended());
  EXPECT_EQ(recording.valid_bytes(), recording.bytes());
  for (const ExecutorKind executor : executors())
    for (const LaunchShape shape : {LaunchShape{}, LaunchShape{2, 4}, LaunchShape{264, 128}})
      for (const LaneOrder order : {LaneOrder::contiguous, LaneOrder::strided, LaneOrder::shuffled}) {
        if (executor == ExecutorKind::cuda && order != LaneOrder::contiguous) continue;
        RunOptions other;
        other.executor = executor;
        other.shape = shape;
        other.lane_order = order;
        other.cpu_threads = order == LaneOrder::strided ? 1 : 3;
        other.broad_phase = order == LaneOrder::shuffled ? "uniform_grid" : "lbvh_ropes";
        const ReplayResult result = replayed(folder / "run", other);
        EXPECT_EQ(result.difference.value_or("none"), "none");
        EXPECT_EQ(result.states, recorded_steps);
        EXPECT_EQ(result.changes, 10);
        EXPECT_EQ(result.keyframes, 12) << "the first, one after each change, the last";
      }
}

TEST(Recording, ADifferenceIsFoundInTheFirstStateThatDiffers) {
  const TemporaryFolder folder;
  record(folder / "run", on_cpu());
  const std::string bytes = text_of(folder / "run");
  const RecordingReader recording(folder / "run");
  // Another hash, of the bodies or with warm-start data, in the third state of a list, with a correct
  // checksum.
  for (const std::size_t part : {0u, 1u}) {
    std::string changed = bytes;
    const auto& events = recording.events();
    const auto hashes = std::ranges::find_if(events, [](const RecordingReader::Event& event) {
      return event.kind == RecordingReader::Kind::hashes;
    });
    ASSERT_EQ(hashes->step, 0);
    const std::size_t third = hashes->begin + 2 * sizeof(StateHashes) + part * 8;
    changed[third] = static_cast<char>(changed[third] ^ 1);
    Fingerprint fingerprint;
    fingerprint.add(changed.data() + hashes->begin - 8, hashes->bytes + 8);
    const std::uint64_t hash = fingerprint.value();
    std::memcpy(changed.data() + hashes->begin + hashes->bytes, &hash, sizeof hash);
    write(folder / "changed", changed);
    const ReplayResult result = replayed(folder / "changed", on_cpu());
    ASSERT_TRUE(result.difference);
    EXPECT_THAT(*result.difference, HasSubstr("state 3: recorded hash"));
    EXPECT_EQ(result.states, 2);
  }
}

TEST(Recording, AFileThatIsCutOffIsValidUpToItsLastCompleteChunk) {
  const TemporaryFolder folder;
  record(folder / "run", on_cpu());
  const std::string bytes = text_of(folder / "run");
  const std::vector<std::size_t> begins = chunk_begins(bytes);
  ASSERT_GT(begins.size(), 20u);
  for (std::size_t k = 2; k + 1 < begins.size(); k += 3)
    for (const std::size_t size : {begins[k], begins[k] + 1, begins[k] + 24, begins[k + 1] - 1}) {
      write(folder / "cut", bytes.substr(0, size));
      const RecordingReader recording(folder / "cut");
      EXPECT_EQ(recording.valid_bytes(), begins[k]) << size;
      EXPECT_EQ(recording.bytes(), size);
      EXPECT_FALSE(recording.ended());
      const ReplayResult result = replayed(folder / "cut", on_cpu());
      EXPECT_EQ(result.difference.value_or("none"), "none") << size;
    }
  // Without a complete keyframe there is nothing to show.
  for (const std::size_t size : {std::size_t{0}, std::size_t{31}, begins[0], begins[1], begins[2] - 1}) {
    write(folder / "cut", bytes.substr(0, size));
    EXPECT_THAT(refusal(folder / "cut"), HasSubstr("cut: byte ")) << size;
  }
}

TEST(Recording, DamageIsReportedWithItsPlace) {
  const TemporaryFolder folder;
  record(folder / "run", on_cpu());
  const std::string bytes = text_of(folder / "run");
  const std::vector<std::size_t> begins = chunk_begins(bytes);
  for (std::size_t k = 0; k + 1 < begins.size(); ++k)
    for (const std::size_t at : {begins[k], begins[k] + 8, begins[k] + 24, begins[k + 1] - 1}) {
      std::string damaged = bytes;
      damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
      write(folder / "damaged", damaged);
      EXPECT_THAT(refusal(folder / "damaged"), HasSubstr("damaged: byte " + std::to_string(begins[k]) + ": "))
          << at;
    }
  std::string other = bytes;
  other[0] = 'C';
  write(folder / "other", other);
  EXPECT_THAT(refusal(folder / "other"), HasSubstr("byte 0: is not a recording"));
  other = bytes;
  other[28] = 2;
  write(folder / "other", other);
  EXPECT_THAT(refusal(folder / "other"), HasSubstr("byte 28: version 2 of the format, expected 1"));
}

/// Files of version 1 of the chunk of hashes contain full_hash() of the state on the host.
TEST(Recording, HashesOfVersion1AreVerified) {
  const TemporaryFolder folder;
  World world(recorded_scene(), on_cpu());
  {
    RecordingWriter writer(folder / "run");
    write_keyframe_chunk(writer, snapshot_of(world));
    std::vector<StateHashes> hashes;
    for (int k = 0; k < 6; ++k) {
      world.step();
      hashes.push_back({world.state_hash(), k % 2 == 0 ? full_hash(world.state()) : 0});
    }
    write_hashes_chunk(writer, 0, hashes);
  }
  std::string bytes = text_of(folder / "run");
  const auto begin = RecordingReader(folder / "run").events().back().begin - 8 - 24;
  const auto write_version = [&](std::uint32_t version) {
    std::memcpy(bytes.data() + begin + 4, &version, sizeof version);
    Fingerprint fingerprint;
    fingerprint.add(bytes.data() + begin, 16);
    const std::uint64_t check = fingerprint.value();
    std::memcpy(bytes.data() + begin + 16, &check, sizeof check);
    write(folder / "run", bytes);
  };
  EXPECT_TRUE(replayed(folder / "run", on_cpu()).difference) << "they are no hashes of version 2";
  write_version(1);
  const ReplayResult result = replayed(folder / "run", on_cpu());
  EXPECT_EQ(result.difference.value_or("none"), "none");
  EXPECT_EQ(result.states, 6);
  RecordedRun run = read_run(RecordingReader(folder / "run"));
  EXPECT_EQ(run.timeline.last(), 6);
  EXPECT_EQ(run.timeline.world_at(5, on_cpu())->steps(), 5);
  write_version(3);
  EXPECT_THAT(refusal(folder / "run"), HasSubstr("unknown version, expected 1 or 2"));
}

TEST(Recording, UnknownChunksAreSkipped) {
  const TemporaryFolder folder;
  World world(recorded_scene(), on_cpu());
  RecordingWriter writer(folder / "run");
  const auto keyframe = [&] {
    std::string payload(16, '\0');
    const std::int64_t steps = world.steps();
    const std::uint64_t hash = full_hash(world.state());
    std::memcpy(payload.data(), &steps, 8);
    std::memcpy(payload.data() + 8, &hash, 8);
    write_snapshot(snapshot_of(world), [&](std::string_view more) { payload += more; });
    writer.write(chunk_types::keyframe, payload);
  };
  writer.write({'N', 'E', 'W', '!'}, "before everything");
  keyframe();
  writer.write(chunk_types::shapes, std::string(1001, 's'));
  world.step();
  const StateHashes hash{world.state_hash(), 0};
  std::string payload(24, '\0');
  std::memcpy(payload.data() + 8, &hash, sizeof hash);
  writer.write(chunk_types::hashes, payload);
  writer.write({'N', 'E', 'W', '!'}, "");
  keyframe();
  const ReplayResult result = replayed(folder / "run", on_cpu());
  EXPECT_EQ(result.difference.value_or("none"), "none");
  EXPECT_EQ(result.states, 1);
  EXPECT_EQ(result.keyframes, 2);
}

TEST(Recording, WarmStartDataIsPartOfTheHash) {
  World world(recorded_scene(), on_cpu());
  world.step(5);
  const RunState state = world.state();
  ASSERT_FALSE(state.warm_start.contacts.empty());
  const std::uint64_t hash = full_hash(state);
  const auto differs = [&](auto edit) {
    RunState other = state;
    edit(other);
    return full_hash(other) != hash;
  };
  EXPECT_FALSE(differs([](RunState&) {}));
  EXPECT_FALSE(differs([](RunState& other) { other.settings ^= 1; })) << "no part of the state";
  EXPECT_TRUE(differs([](RunState& other) { other.warm_start.contacts[0].impulse += 1; }));
  EXPECT_TRUE(differs([](RunState& other) { other.warm_start.friction[0][1] += 1; }));
  EXPECT_TRUE(differs([](RunState& other) { other.warm_start.walls[0][0] += 1; }));
  EXPECT_TRUE(differs([](RunState& other) { other.warm_start.sleep_timer[0] += 1; }));
  EXPECT_TRUE(differs([](RunState& other) { other.static_impulses[0].push_work += 1; }));
  EXPECT_TRUE(differs([](RunState& other) { other.bodies.position[0].x() += 1; }));
  EXPECT_TRUE(differs([](RunState& other) { other.frozen.push_back(0); }));
  EXPECT_TRUE(differs([](RunState& other) { ++other.steps; }));
}

// ---- the program ----

TEST(Recording, TheProgramRecordsVerifiesAndContinues) {
  const TemporaryFolder folder;
  const std::string file = folder / "run";
  write(folder / "changes.json", recorded_changes);
  const Outcome recorded =
      run_headless({"run", "box_collider", "--bodies", "60", "--steps", "60", "--executor", "cpu",
                    "--changes", folder / "changes.json", "--record", file});
  ASSERT_EQ(recorded.status, 0) << recorded.err;
  const Outcome verified =
      run_headless({"replay", file, "--executor", "cpu", "--cpu-threads", "1", "--json", "-"});
  EXPECT_EQ(verified.status, 0) << verified.err;
  EXPECT_THAT(verified.out, HasSubstr("\"agrees\": true"));
  EXPECT_THAT(verified.out, HasSubstr("\"states\": 60"));
  // It continues at its end.
  const auto hash_of = [](const Outcome& outcome) {
    const std::size_t at = outcome.out.find("\"state_hash\": ");
    return at == std::string::npos ? outcome.err : outcome.out.substr(at, 33);
  };
  const std::vector<std::string> more{"--steps", "20", "--executor", "cpu", "--json", "-"};
  const auto with = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return hash_of(run_headless(arguments));
  };
  run_headless({"run", "box_collider", "--bodies", "60", "--steps", "60", "--executor", "cpu", "--changes",
                folder / "changes.json", "--save", folder / "end"});
  const std::string expected = with({"run", "--load", folder / "end"});
  EXPECT_THAT(expected, StartsWith("\"state_hash\""));
  EXPECT_EQ(with({"run", "--load", file}), expected);
  EXPECT_EQ(with({"run", file}), expected);
}

TEST(Recording, OfAKilledProgramIsValid) {
  const TemporaryFolder folder;
  const std::string file = folder / "run";
  const pid_t child = fork();
  if (child == 0)
    become_program(headless_program(),
                   {"run", "box_collider", "--bodies", "300", "--steps", "1000000", "--executor", "cpu",
                    "--record", file},
                   {}, "/dev/null", "/dev/null");
  const auto recorded_states = [&]() -> std::int64_t {
    try {
      std::int64_t states = 0;
      const RecordingReader recording(file);
      for (const RecordingReader::Event& event : recording.events()) states += std::ssize(event.hashes);
      return states;
    } catch (const InputError&) {
      return 0;  // not begun
    }
  };
  int status = 0;
  while (recorded_states() < 150 && waitpid(child, &status, WNOHANG) == 0) usleep(20'000);
  kill(child, SIGKILL);
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  const Outcome verified = run_headless({"replay", file, "--executor", "cpu"});
  EXPECT_EQ(verified.status, 0) << verified.err;
  EXPECT_THAT(verified.out, HasSubstr("the recorded run did not end"));
}

TEST(Recording, TheProgramTellsOfOtherPhysicsAndOfBadFiles) {
  const TemporaryFolder folder;
  const std::string file = folder / "run";
  World world(recorded_scene(), on_cpu());
  Snapshot snapshot = snapshot_of(world);
  snapshot.physics_version = 3;
  std::string payload(16, '\0');
  write_snapshot(snapshot, [&](std::string_view more) { payload += more; });
  RecordingWriter(file).write(chunk_types::keyframe, payload);
  const Outcome other = run_headless({"replay", file, "--executor", "cpu"});
  EXPECT_EQ(other.status, 3);
  EXPECT_THAT(other.err, HasSubstr("cannot verify: recorded with physics version 3"));
  EXPECT_EQ(run_headless({"run", file, "--steps", "1", "--executor", "cpu"}).status, 0) << "it can be opened";

  for (const auto& [arguments, message] :
       {std::pair{std::vector<std::string>{"replay"}, "replay: missing file, expected replay FILE"},
        {{"replay", "nowhere"}, "nowhere: is not a regular file; expected a recording"},
        {{"replay", headless_program()}, "byte 0: is not a recording"},
        {{"replay", file, "--substeps=3"}, "--substeps=3: unknown flag"},
        {{"run", "box_collider", "--record", folder.path()}, "is not a regular file"},
        {{"run", "box_collider", "--record", "/dev/full"}, "is not a regular file"},
        {{"run", "box_collider", "--record", file, "--save", file}, "expected a different file"}}) {
    const Outcome outcome = run_headless(arguments);
    EXPECT_EQ(outcome.status, 2) << message;
    EXPECT_THAT(outcome.err, HasSubstr(message));
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
  }
}

TEST(Recording, AFullDiskEndsTheRunAndLeavesAValidFile) {
  const TemporaryFolder folder;
  const std::string file = folder / "run";
  const Outcome full = run_headless(
      {"run", "box_collider", "--bodies", "200", "--steps", "5000", "--executor", "cpu", "--record", file},
      Launch{.max_file_bytes = 400'000});
  EXPECT_EQ(full.status, 3);
  EXPECT_THAT(full.err, HasSubstr("the recording is valid up to byte"));
  EXPECT_EQ(run_headless({"replay", file, "--executor", "cpu"}).status, 0);
}

}  // namespace
}  // namespace collidoscope

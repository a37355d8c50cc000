// Tests snapshots: a run continues bit for bit, and incomplete, foreign or newer files are refused.

#include "sim_cuda/snapshot/snapshot.h"
#include "sim_cuda/scene/joint_trees.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "sim_cuda/changes/changes.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/hash.h"
#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/run/run_state.h"
#include "tests/executors.h"
#include "tests/scenes.h"
#include "tests/test_files.h"

namespace collidoscope {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string bytes_of(const Snapshot& snapshot) {
  std::string bytes;
  write_snapshot(snapshot, [&](std::string_view more) { bytes += more; });
  return bytes;
}

void write_file(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

Snapshot by_way_of_a_file(const Snapshot& snapshot) {
  const TemporaryFolder folder;
  write_file(folder / "s", bytes_of(snapshot));
  return read_snapshot(folder / "s");
}

/// Steps `world` and a world made from its snapshot, and compares them.
void step_also_from_a_file(World& world) {
  const Snapshot snapshot = by_way_of_a_file(snapshot_of(world));
  World again = world_from(snapshot, snapshot.scene, world.options());
  world.step(1);
  again.step(1);
  EXPECT_EQ(again.state_hash(), world.state_hash()) << "step " << world.steps();
}

Scene box_with_friction(std::int64_t bodies) {
  Scene scene = box_collider(bodies);
  scene.generators[0].radius_max = 7;
  scene.generators[0].speed_max = 3;
  scene.physics.solver = Solver::soft_step;
  scene.materials[0].friction = 0.4;
  for (int k = 0; k < 8; ++k) {
    Joint& joint = scene.joints.emplace_back();
    joint.kind = k % 2 == 0 ? JointKind::ball : JointKind::distance;
    joint.a = k;
    joint.b = k + 1;
  }
  scene.materials[0].rolling_resistance = 0.1;
  return scene;
}

class Snapshots : public OnEachExecutor {};
ON_EACH_EXECUTOR(Snapshots);

TEST_P(Snapshots, ARunGoesOnBitForBit) {
  Scene plain = box_collider(400);
  plain.generators[0].radius_max = 7;
  for (const Solver solver : {Solver::impulse, Solver::soft_step})
    for (const Precision precision : {Precision::f32, Precision::f64})
      for (const bool has_friction : {false, true}) {
        if (has_friction && solver == Solver::impulse) continue;
        Scene scene = has_friction ? box_with_friction(400) : plain;
        scene.physics.solver = solver;
        scene.physics.precision = precision;
        World whole(scene, options()), first(scene, options());
        whole.step(50);
        first.step(21);
        const Snapshot snapshot = by_way_of_a_file(snapshot_of(first));
        EXPECT_EQ(snapshot.state_hash, first.state_hash());
        RunOptions other;
        other.executor = ExecutorKind::cpu;
        other.broad_phase = "brute_force";
        World second = world_from(snapshot, snapshot.scene, other);
        EXPECT_EQ(second.steps(), 21);
        EXPECT_EQ(second.state_hash(), first.state_hash());
        second.step(29);
        EXPECT_EQ(second.state_hash(), whole.state_hash());
        EXPECT_EQ(second.measure().wall_impulse, whole.measure().wall_impulse);
        EXPECT_EQ(bytes_of(snapshot_of(second)), bytes_of(snapshot_of(whole))) << "caches too";
      }
}

/// The snapshot does not store the face through which a ball entered a box. Each substep must find the same
/// face again.
TEST_P(Snapshots, OfBallsInsideABoxGoOnBitForBit) {
  for (const double coulomb : {0.3, 1.0}) {
    Scene scene = hard_space(Vector3d(0, 0, -9.81), 0);
    scene.physics.iterations = 3;
    scene.materials[0].friction = coulomb;
    scene.bodies = {sphere(1, Vector3d(0, 0, 0.5), Vector3d(3, 0, 0)),
                    sphere(0.6, Vector3d(1, 0.1, 0.4), Vector3d(0, -3, 0))};
    scene.bodies[1].angular_velocity = Vector3d(0, 17, 18);
    scene.boxes.emplace_back().size = Vector3d(4, 4, 2);
    SCOPED_TRACE(coulomb);
    World whole(scene, options());
    for (int step = 1; step <= 8; ++step) step_also_from_a_file(whole);
  }
}

/// Friction changes an angular velocity after its part beyond float was computed (wide_spin.h). With this
/// start, the old part would fit the new value a step later.
TEST_P(Snapshots, OfATumblingBodyInAGrooveGoOnBitForBit) {
  const Scene scene = parse_scene(R"({"format": "collidoscope-scene", "version": 1, "steps_per_second": 60,
    "materials": {"default": {"friction": 0.5, "restitution": 0.5}},
    "obstacles": [{"shape": "plane"}, {"shape": "plane", "normal": [1, 0, 1], "offset": 0}],
    "bodies": [{"radius": 0.20597665441932264, "position": [0, 0, 0.2721460285736765],
      "orientation": [-0.41342907543159674, 0.4854442978490827, -1.1251656160437273, -0.8576051119758246],
      "angular_velocity": [-12.573712073489672, -2.5965754071919185, 22.48396904274102],
      "mass": 62.6654201746669, "inertia": [0.7976001194728242, 1.0634668259637658, 1.329333532454707]}]})",
                                  "s");
  World whole(scene, options());
  for (int step = 1; step <= 30; ++step) step_also_from_a_file(whole);
}

/// A hinge of 4,000 km in many loops, so that it is iterated, gives two bodies NaN states. One of them is in
/// contact with a kinematic ball at a wall, and a third body comes to rest on that ball.
TEST_P(Snapshots, BesideBodiesThatFailedGoOnBitForBit) {
  Scene scene =
      parse_scene(R"({"format": "collidoscope-scene", "version": 1, "steps_per_second": 60, "iterations": 3,
    "box": {"min": [0, -4.48, -1.8], "max": [50, 30.5, 22.6]},
    "materials": {"default": {"density": 8667.96, "restitution": 0.57, "friction": 2.6e-6}},
    "bodies": [
      {"radius": 2.97, "position": [22, 4038423, 10.4], "inertia": [1e-36, 1.08e-36, 1.47e-36]},
      {"radius": 9, "motion": "kinematic", "position": [27.6, 13.03, 2.73]},
      {"radius": 1.57, "position": [29.07, 13.03, -99999990]},
      {"radius": 0.0187, "position": [21.33, 14.27, 3.53]}],
    "joints": [{"kind": "hinge", "a": 0, "b": 3, "limits": [-61.2, 2.48]},
      {"kind": "distance", "a": 0, "b": 3, "max_length": 1e9}]})",
                  "s");
  scene.joints.resize(2 + JointTrees::max_closing_rows, scene.joints.back());
  World whole(scene, options());
  for (int step = 1; step <= 4; ++step) step_also_from_a_file(whole);
  EXPECT_FALSE(whole.bodies().position[3].allFinite());
  EXPECT_TRUE(whole.bodies().position[2].allFinite());
}

TEST_P(Snapshots, ATurnedSettingActsAsInAWorldThatAdopts) {
  World first(box_with_friction(300), options());
  first.step(20);
  const Snapshot snapshot = by_way_of_a_file(snapshot_of(first));
  Scene edited = snapshot.scene;
  edited.materials[0].restitution = 0.1;
  edited.physics.precision = Precision::f64;
  edited.generators[0].count = 350;
  World adopted(edited, options());
  adopted.restore(first);
  World loaded = world_from(snapshot, edited, options());
  adopted.step(10);
  loaded.step(10);
  EXPECT_EQ(loaded.state_hash(), adopted.state_hash());
}

TEST(Snapshot, OfNothingAndOfMeshes) {
  RunOptions o;
  o.executor = ExecutorKind::cpu;
  for (const char* name : {"empty", "tumbling_mesh", "one_body"}) {
    World world(project_scene(name), o);
    world.step(5);
    const Snapshot snapshot = by_way_of_a_file(snapshot_of(world));
    World again = world_from(snapshot, snapshot.scene, o);
    EXPECT_EQ(again.state_hash(), world.state_hash()) << name;
  }
}

TEST(Snapshot, AMeshThatHasChangedIsRefused) {
  RunOptions o;
  o.executor = ExecutorKind::cpu;
  const TemporaryFolder folder;
  const std::string tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  write_file(folder / "a.obj", tetrahedron);
  Scene scene = empty_space();
  scene.directory = folder.path().string();
  scene.bodies.resize(1);
  scene.bodies[0].shape = Shape::mesh;
  scene.bodies[0].mesh = "a.obj";
  World world(scene, o);
  write_file(folder / "s", bytes_of(snapshot_of(world)));
  const Snapshot snapshot = read_snapshot(folder / "s");
  EXPECT_EQ(world_from(snapshot, snapshot.scene, o).state_hash(), world.state_hash());
  write_file(folder / "a.obj", "v 0 0 0\nv 2 0 0\n" + tetrahedron.substr(16));
  try {
    world_from(snapshot, snapshot.scene, o);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("a file of meshes or bodies may have changed"));
  }
}

/// A snapshot with one kind of damage, and the message about it.
class SpoiltSnapshot : public testing::Test {
 protected:
  SpoiltSnapshot() {
    RunOptions o;
    o.executor = ExecutorKind::cpu;
    World world(box_with_friction(20), o);
    world.step(3);
    good_ = bytes_of(snapshot_of(world));
  }

  std::string line(const std::string& file) {
    try {
      read_snapshot(file);
    } catch (const InputError& error) {
      EXPECT_EQ(error.lines().size(), 1u);
      EXPECT_THAT(error.what(), StartsWith(file + ": "));
      return std::string(error.what()).substr(file.size() + 2);
    }
    return "read";
  }
  std::string line_of(const std::string& bytes) {
    write_file(folder_ / "s", bytes);
    return line(folder_ / "s");
  }
  /// The snapshot with eight bytes replaced at `at` and a matching hash.
  std::string with(std::size_t at, std::uint64_t value) const {
    std::string bytes = good_;
    std::memcpy(bytes.data() + at, &value, 8);
    std::uint64_t hash = 0, word = 0;
    for (std::size_t k = 0; k + 8 < bytes.size(); k += 8) {
      std::memcpy(&word, bytes.data() + k, 8);
      hash = mix64(hash ^ word);
    }
    std::memcpy(bytes.data() + bytes.size() - 8, &hash, 8);
    return bytes;
  }

  std::string good_;
  TemporaryFolder folder_;
};

TEST_F(SpoiltSnapshot, OfTheFirstVersionItIsReadWithoutFrozenBodies) {
  // The first version lacks the last two lists, empty here, the time and the physics version.
  good_.erase(good_.size() - 40, 32);
  const std::uint64_t size = good_.size();
  good_[24] = 1;
  EXPECT_EQ(line_of(with(32, size)), "read");
  EXPECT_EQ(read_snapshot(folder_ / "s").state.steps, 3);
  EXPECT_TRUE(std::isnan(read_snapshot(folder_ / "s").state.time));
  EXPECT_EQ(read_snapshot(folder_ / "s").physics_version, 1);
}

TEST_F(SpoiltSnapshot, OfTheSecondVersionItIsReadWithoutATime) {
  good_.erase(good_.size() - 32, 24);
  const std::uint64_t size = good_.size();
  good_[24] = 2;
  EXPECT_EQ(line_of(with(32, size)), "read");
  EXPECT_TRUE(std::isnan(read_snapshot(folder_ / "s").state.time));
}

TEST_F(SpoiltSnapshot, OfTheFourthVersionItHasNoLoopEnergies) {
  good_.erase(good_.size() - 16, 8);
  const std::uint64_t size = good_.size();
  good_[24] = 4;
  EXPECT_EQ(line_of(with(32, size)), "read");
  EXPECT_EQ(read_snapshot(folder_ / "s").physics_version, physics_version);
}

TEST_F(SpoiltSnapshot, OfTheThirdVersionItHasTheFirstPhysics) {
  good_.erase(good_.size() - 24, 16);
  const std::uint64_t size = good_.size();
  good_[24] = 3;
  EXPECT_EQ(line_of(with(32, size)), "read");
  EXPECT_FALSE(std::isnan(read_snapshot(folder_ / "s").state.time));
  EXPECT_EQ(read_snapshot(folder_ / "s").physics_version, 1);
}

TEST_F(SpoiltSnapshot, HasItsPhysicsVersion) {
  const std::size_t at = good_.size() - 24;
  EXPECT_EQ(line_of(good_), "read");
  EXPECT_EQ(read_snapshot(folder_ / "s").physics_version, physics_version);
  EXPECT_EQ(line_of(with(at, 1000)), "read");
  EXPECT_EQ(read_snapshot(folder_ / "s").physics_version, 1000);
  EXPECT_EQ(bytes_of(read_snapshot(folder_ / "s")), with(at, 1000));
  EXPECT_EQ(line_of(with(at, 0)), "is damaged: its physics version is 0");
  EXPECT_EQ(line_of(with(at, ~std::uint64_t{0})), "is damaged: its physics version is -1");
}

TEST_F(SpoiltSnapshot, WholeItIsRead) { EXPECT_EQ(line_of(good_), "read"); }

TEST_F(SpoiltSnapshot, CutShortAnywhere) {
  for (std::size_t bytes = 0; bytes < good_.size(); bytes += bytes < 64 ? 1 : 97)
    EXPECT_THAT(line_of(good_.substr(0, bytes)),
                HasSubstr(bytes < 40 ? "is not a snapshot" : "is damaged: it has"));
  EXPECT_THAT(line_of(good_ + "more"), HasSubstr("is damaged: it has"));
}

TEST_F(SpoiltSnapshot, AlteredAnywhere) {
  for (std::size_t at = 0; at < good_.size(); at += at < 64 ? 1 : 89) {
    std::string bytes = good_;
    bytes[at] = static_cast<char>(bytes[at] ^ 4);
    EXPECT_NE(line_of(bytes), "read") << at;
  }
}

TEST_F(SpoiltSnapshot, ForeignNewerAndNoFile) {
  EXPECT_THAT(line_of("{\"format\": \"collidoscope-scene\", \"version\": 1, \"name\": \"a scene\"}"),
              HasSubstr("is not a snapshot; \"collidoscope-headless run SCENE --save FILE\" writes one"));
  std::string newer = good_;
  newer[24] = static_cast<char>(snapshot_version + 1);
  EXPECT_THAT(line_of(newer), HasSubstr("use a newer version"));
  std::string turned = good_;
  std::swap(turned[28], turned[31]);
  EXPECT_THAT(line_of(turned), HasSubstr("byte order"));
  EXPECT_THAT(line(folder_ / "none"), HasSubstr("cannot be opened (No such file or directory)"));
  EXPECT_THAT(line(folder_.path()), HasSubstr("is a folder"));
  EXPECT_THAT(line("/dev/zero"), HasSubstr("is not a snapshot"));
}

TEST_F(SpoiltSnapshot, AListLongerThanTheFileTakesNoMemory) {
  // The length of the first list follows the header, the scene, the folder and four numbers.
  std::uint64_t scene_bytes = 0;
  std::memcpy(&scene_bytes, good_.data() + 40, 8);
  EXPECT_THAT(line_of(with(40, std::uint64_t{1} << 60)), HasSubstr("longer than the file"));
  const std::size_t positions = 48 + (scene_bytes + 7) / 8 * 8 + 8 + 4 * 8;
  for (const std::uint64_t bodies : {std::uint64_t{1} << 61, ~std::uint64_t{0}, std::uint64_t{1} << 40})
    EXPECT_THAT(line_of(with(positions, bodies)), HasSubstr("longer than the file"));
  EXPECT_THAT(line_of(with(positions, 19)), HasSubstr("is damaged"));
  // A sparse file of a terabyte does not match its header.
  write_file(folder_ / "s", good_);
  std::filesystem::resize_file(folder_ / "s", std::uintmax_t{1} << 40);
  EXPECT_THAT(line(folder_ / "s"), HasSubstr("is damaged: it has 1099511627776 of"));
}

TEST(SnapshotOfARun, KnowsTheTimeAlsoOfStepsOfOtherLengths) {
  const TemporaryFolder folder;
  RunOptions o;
  o.executor = ExecutorKind::cpu;
  Scene scene = box_with_friction(20);
  scene.physics.time_step = 0.125;
  World first(scene, o);
  first.step(4);
  EXPECT_EQ(first.time(), 0.5);
  write_file(folder / "s", bytes_of(snapshot_of(first)));
  const Snapshot snapshot = read_snapshot(folder / "s");
  scene.physics.time_step = 0.25;
  World second = world_from(snapshot, scene, o);
  second.step(2);
  EXPECT_EQ(second.time(), 1);
  Change shorter;
  shorter.step = 6;
  shorter.settings.set<&Physics::time_step>(0.0625);
  const auto changed = world_after_change(second, shorter, o);
  changed->step(2);
  EXPECT_EQ(changed->time(), 1.125);
  EXPECT_EQ(changed->steps(), 8);
}

}  // namespace
}  // namespace collidoscope

// Tests changes during a run: equal results on every executor, minimal effect on other bodies, and replay
// from a file.

#include "sim_cuda/changes/changes.h"

#include <gmock/gmock.h>

#include <fstream>

#include "headless/change_replay.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/run/run_state.h"
#include "sim_cuda/snapshot/snapshot.h"
#include "sim_cuda/solver/sleeping.h"
#include "tests/executors.h"
#include "tests/scenes.h"
#include "tests/sleeping_scenes.h"

namespace collidoscope {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Change removal(std::vector<std::int64_t> ids) {
  Change change;
  change.remove = std::move(ids);
  return change;
}

Change addition(const Body& body) {
  Change change;
  change.add = {body};
  return change;
}

class Changes : public OnEachExecutor {};
ON_EACH_EXECUTOR(Changes);

/// Spheres with friction, rolling resistance and sleeping, in contact from the start. Two of them are joined.
Scene crowd() {
  Scene scene = box_collider(120);
  scene.box->max = Vector3d(24, 24, 24);
  scene.generators[0].radius_max = 3;
  scene.generators[0].speed_max = 4;
  scene.generators[0].spawn = Spawn::inside;
  scene.bodies = {sphere(1, Vector3d(4, 4, 2)), sphere(1, Vector3d(6, 4, 2))};
  scene.materials[0].friction = 0.4;
  scene.materials[0].rolling_resistance = 0.05;
  scene.physics.solver = Solver::soft_step;
  scene.physics.sleep = Sleep{};
  scene.joints.resize(2);
  scene.joints[0].kind = JointKind::distance;
  scene.joints[0].a = 0;
  scene.joints[0].b = 1;
  scene.joints[1] = scene.joints[0];
  scene.joints[1].a = 60;
  scene.joints[1].b = 90;
  return scene;
}

/// A changes file with every kind of change, each at a state of its own.
const char* const script = R"({"format": "collidoscope-changes", "version": 1, "changes": [
  {"step": 4, "bodies": 170},
  {"step": 7, "effects": ["gravity", "rotation", "joints", "sleeping"]},
  {"step": 10, "effects": "auto", "blocks": 3, "threads": 32},
  {"step": 13, "bodies": 140},
  {"step": 16, "effects": ["gravity", "joints"]},
  {"step": 18, "add": [{"radius": 2, "position": [12, 12, 20], "velocity": [0, 1, -30], "angular_velocity": [0, 9, 0]},
                       {"radius": 1, "position": [3, 20, 20], "mass": 9e4}]},
  {"step": 20, "freeze": [3, 70]},
  {"step": 21, "effects": "auto"},
  {"step": 24, "remove": [0, 77, 142, 60]},
  {"step": 27, "solver": "impulse", "effects": ["gravity", "rotation"]},
  {"step": 30, "solver": "soft_step", "effects": "auto", "substeps": 6, "iterations": 2},
  {"step": 33, "bodies": 150, "remove": [90, 91], "freeze": [20, 90, 70]},
  {"step": 36, "time_step": 0.01, "restitution": 0.3, "substeps": "auto"},
  {"step": 39, "precision": "f64"},
  {"step": 42, "precision": "f32", "broad_phase": "uniform_grid", "blocks": "auto"},
  {"step": 43, "integrator": "velocity_verlet"},
  {"step": 44, "integrator": "rk4", "rotation_update": "lie_group"},
  {"step": 45, "solver": "jacobi_split"},
  {"step": 48, "solver": "soft_step", "steps_per_second": 60},
  {"step": 48, "bodies": 100}
]})";
constexpr int script_steps = 54;

/// The world at the end of a run with this changes file.
World replayed(const Scene& scene, const std::string& text, const RunOptions& options, std::int64_t steps) {
  const TemporaryFolder folder;
  std::ofstream(folder / "changes.json") << text;
  Start start{scene, {}};
  RunOptions how = options;
  ChangeReplay replay(folder / "changes.json", start, how);
  World world = start.world(how);
  replay.make_due(world);
  while (world.steps() < steps) {
    world.step(static_cast<int>(std::min(steps - world.steps(), replay.steps_to_next(world))));
    replay.make_due(world);
  }
  EXPECT_EQ(replay.left(), 0u);
  return world;
}

TEST_P(Changes, LeadToTheSameStateHoweverTheyRun) {
  RunOptions plain;
  plain.executor = ExecutorKind::cpu;
  World expected = replayed(crowd(), script, plain, script_steps);
  EXPECT_EQ(expected.initial().size(), 1u + 96u + 1u);
  EXPECT_GT(expected.measure().speculative, 10);
  const auto same = [&](auto edit, const char* what) {
    RunOptions o = options();
    edit(o);
    World world = replayed(crowd(), script, o, script_steps);
    EXPECT_EQ(world.state_hash(), expected.state_hash()) << what;
  };
  same([](RunOptions&) {}, "auto");
  same([](RunOptions& o) { o.shape = {2, 4}; }, "(2, 4)");
  same([](RunOptions& o) { o.shape = {264, 128}; }, "(264, 128)");
  same([](RunOptions& o) { o.broad_phase = "brute_force"; }, "brute force");
  same([](RunOptions& o) { o.broad_phase = "ploc"; }, "ploc");
  same([](RunOptions& o) { o.initial_pair_capacity = 8; }, "little room at first");
  same(
      [](RunOptions& o) {
        o.lane_order = LaneOrder::shuffled;
        o.cpu_threads = 3;
      },
      "shuffled");
}

TEST_P(Changes, FreezeBodiesWhereTheyAre) {
  const char* const text = R"({"format": "collidoscope-changes", "version": 1, "changes": [
    {"step": 0, "freeze": [9]}, {"step": 0, "restitution": 0.5},
    {"step": 5, "freeze": [2, 9], "remove": [1]}]})";
  World world = replayed(crowd(), text, options(), 5);
  EXPECT_THAT(world.validation().frozen(), ElementsAre(1, 8));
  const BodyStates before = world.bodies();
  EXPECT_EQ(before.position[8], world.initial().position[8]) << "since state 0";
  world.step(5);
  for (const std::size_t body : {1u, 8u}) EXPECT_EQ(world.bodies().position[body], before.position[body]);
  EXPECT_NE(world.bodies().position[2], before.position[2]);
}

/// They have impulses of rolling resistance when they are frozen.
TEST_P(Changes, FrozenBodiesThatRolledStayFinite) {
  for (const Solver solver : {Solver::soft_step, Solver::jacobi_split})
    for (const Precision precision : {Precision::f32, Precision::f64}) {
      Scene scene = empty_space();
      scene.physics.solver = solver;
      scene.physics.precision = precision;
      scene.physics.gravity = Vector3d(1, 0, -9.81);
      scene.materials[0] = {.restitution = 0, .friction = 0.5, .rolling_resistance = 0.1};
      scene.obstacles = {Plane{}};
      for (int k = 0; k < 3; ++k) scene.bodies.push_back(sphere(0.5, Vector3d(0.01 * k, 0, 0.5 + 0.99 * k)));
      World world = replayed(scene, R"({"format": "collidoscope-changes", "version": 1, "changes": [
        {"step": 10, "freeze": [0, 1]}]})",
                             options(), 40);
      EXPECT_EQ(world.measure().non_finite, 0);
      for (const std::size_t body : {0u, 1u}) {
        EXPECT_EQ(world.bodies().velocity[body], Vector3d(0, 0, 0));
        EXPECT_EQ(world.bodies().angular_velocity[body], Vector3d(0, 0, 0));
      }
      EXPECT_LT(world.bodies().position[2].z(), 2.4) << "it rolls off";
    }
}

TEST_P(Changes, ASnapshotBetweenThemGoesOn) {
  World expected = replayed(crowd(), script, options(), script_steps);
  const ChangeList list = parse_changes(script, "script", crowd(), options(), 0);
  std::size_t next = 0;
  std::optional<World> world;
  world.emplace(crowd(), options());
  while (world->steps() < script_steps) {
    for (; next < list.changes.size() && list.changes[next].step == world->steps(); ++next)
      if (auto changed = world_after_change(*world, list.changes[next], world->options()))
        world.emplace(std::move(*changed));
    if (world->steps() == 19 || world->steps() == 25 || world->steps() == 34 || world->steps() == 50) {
      const TemporaryFolder folder;
      std::ofstream file(folder / "s", std::ios::binary);
      write_snapshot(snapshot_of(*world), [&](std::string_view bytes) { file << bytes; });
      file.close();
      const Snapshot snapshot = read_snapshot(folder / "s");
      EXPECT_EQ(snapshot.state_hash, world->state_hash());
      world.emplace(world_from(snapshot, snapshot.scene, options()));
    }
    world->step();
  }
  EXPECT_EQ(world->state_hash(), expected.state_hash());
}

TEST_P(Changes, WhoIsRemovedLeavesTheOthersAsTheyAre) {
  World world(crowd(), options());
  world.step(12);
  const RunState before = world.state();
  const std::unique_ptr<World> after = world_after_change(world, removal({60, 0, 121}), options());
  const RunState state = after->state();
  ASSERT_EQ(state.bodies.position.size(), 119u);
  std::vector<std::uint32_t> old;  // old ids, by new id
  for (std::uint32_t id = 0; id < 122; ++id)
    if (id != 0 && id != 60 && id != 121) old.push_back(id);
  for (std::size_t i = 0; i < old.size(); ++i) {
    EXPECT_EQ(state.bodies.position[i], before.bodies.position[old[i]]) << i;
    EXPECT_EQ(state.bodies.angular_velocity[i], before.bodies.angular_velocity[old[i]]) << i;
    EXPECT_EQ(after->initial().radius[i], world.initial().radius[old[i]]) << i;
    EXPECT_EQ(after->initial().mass[i], world.initial().mass[old[i]]) << i;
    EXPECT_EQ(state.warm_start.walls[4][i], before.warm_start.walls[4][old[i]]) << i;
  }
  // Contacts between remaining bodies keep their cached impulses.
  std::vector<std::array<std::uint32_t, 2>> kept;
  std::vector<double> impulses;
  for (const ContactImpulse& c : before.warm_start.contacts)
    if (std::ranges::find(old, c.a) != old.end() && std::ranges::find(old, c.b) != old.end()) {
      kept.push_back({c.a, c.b});
      impulses.push_back(c.impulse);
    }
  ASSERT_GT(kept.size(), 10u);
  ASSERT_EQ(state.warm_start.contacts.size(), kept.size());
  for (std::size_t k = 0; k < kept.size(); ++k) {
    EXPECT_EQ(old[state.warm_start.contacts[k].a], kept[k][0]);
    EXPECT_EQ(old[state.warm_start.contacts[k].b], kept[k][1]);
    EXPECT_EQ(state.warm_start.contacts[k].impulse, impulses[k]);
  }
  EXPECT_TRUE(after->scene().joints.empty()) << "each had lost a body";
}

TEST_P(Changes, ABodyFarAwayDisturbsNobody) {
  Scene scene = crowd();
  scene.box.reset();
  scene.generators.clear();
  scene.joints.resize(1);
  Random random(3);
  for (int k = 0; k < 60; ++k) {
    const auto u = [&] { return 5 * (random() / 4294967296.0); };
    scene.bodies.push_back(sphere(0.5, Vector3d(u(), u(), 1 + 2 * u())));
  }
  scene.obstacles.push_back({});
  World alone(scene, options()), first(scene, options());
  alone.step(40);
  first.step(15);
  std::unique_ptr<World> both =
      world_after_change(first, addition(sphere(1, Vector3d(500, 0, 30))), options());
  both->step(10);
  EXPECT_LT(both->bodies().position.back().z(), 30);
  both = world_after_change(*both, removal({62}), options());
  both->step(15);
  EXPECT_EQ(both->state_hash(), alone.state_hash());
}

TEST_P(Changes, SleepersWakeWhereSomethingTheyTouchedIsRemoved) {
  const Scene scene = sleeping_columns({0, 10}, 3);
  World world(scene, options());
  world.step(60);
  ASSERT_THAT(bodies_asleep(world), ElementsAre(true, true, true, true, true, true));
  const std::unique_ptr<World> next = world_after_change(world, removal({0}), options());
  next->step();
  EXPECT_THAT(bodies_asleep(*next), ElementsAre(false, false, true, true, true));
  next->step(30);
  EXPECT_LT(next->bodies().position[1].z(), 4) << "it has fallen by a body";
}

TEST(Change, AtState0IsAsIfTheSceneHadSaidSo) {
  RunOptions o;
  o.executor = ExecutorKind::cpu;
  const std::string text = R"({"format": "collidoscope-changes", "version": 1, "changes": [
    {"step": 0, "bodies": 90, "seed": 7, "variant": "equal", "radius_max": 2, "precision": "f64"},
    {"step": 0, "remove": [5], "add": [{"radius": 1, "position": [3, 3, 3]}]}]})";
  World changed = replayed(crowd(), text, o, 20);
  Scene scene = crowd();
  BoxCollider& generator = scene.generators[0];
  generator.count = 90;
  generator.seed = 7;
  generator.variant = Variant::equal;
  generator.radius_max = 2;
  generator.excluded = {3};
  scene.physics.precision = Precision::f64;
  scene.extra_bodies = {sphere(1, Vector3d(3, 3, 3))};
  scene.joints.erase(scene.joints.begin() + 1);
  scene.joints.push_back(scene.joints[0]);
  scene.joints[1].a = 59;
  scene.joints[1].b = 89;
  World said(scene, o);
  said.step(20);
  EXPECT_EQ(changed.state_hash(), said.state_hash());
}

TEST(Change, FilesReadBackAsTheyWere) {
  const RunOptions o;
  const ChangeList list = parse_changes(script, "script", crowd(), o, 0);
  ASSERT_EQ(list.changes.size(), 20u);
  EXPECT_FALSE(list.end.has_value());
  const ChangeList with_end{list.changes, RecordedEnd{54, 0x0123456789abcdefu, 7}};
  const std::string text = write_changes(with_end, crowd());
  const ChangeList again = parse_changes(text, "text", crowd(), o, 0);
  ASSERT_TRUE(again.end.has_value());
  EXPECT_EQ(again.end->step, 54);
  EXPECT_EQ(again.end->state_hash, 0x0123456789abcdefu);
  EXPECT_EQ(again.end->physics_version, 7);
  std::string older = text;
  older.replace(older.find(", \"physics_version\": 7"), 22, "");
  EXPECT_EQ(parse_changes(older, "text", crowd(), o, 0).end->physics_version, 1);
  EXPECT_EQ(write_changes(again, crowd()), text);
  EXPECT_EQ(again.changes[5].add[1].mass, 9e4);
  EXPECT_EQ(again.changes[5].add[0].angular_velocity, Vector3d(0, 9, 0));
  EXPECT_THAT(again.changes[6].freeze, ElementsAre(3, 70));
  EXPECT_EQ(again.changes[16].settings.get<&Physics::integrator>(), Integrator::rk4);
  EXPECT_EQ(again.changes[16].settings.get<&Physics::rotation_update>(), RotationUpdate::lie_group);
}

/// The message for a list with this second line. The scene is crowd(), with or without generators.
std::string changes_fault(const std::string& changes, std::int64_t start = 0, bool generated = true) {
  Scene scene = crowd();
  if (!generated) {
    scene.generators.clear();
    scene.joints.clear();
  }
  try {
    parse_changes(
        "{\"format\": \"collidoscope-changes\", \"version\": 1, \"changes\": [\n" + changes + "\n]}", "f",
        scene, {}, start);
  } catch (const InputError& error) {
    return error.lines().at(0);
  }
  return "";
}

TEST(Change, FaultsSayWhereAndWhat) {
  EXPECT_EQ(changes_fault(R"({"step": 3, "bodies": 5, "remove": [6]})"), "");
  EXPECT_EQ(changes_fault(R"({"bodies": 5})"),
            "f:2:1: a change must have a \"step\", the number of the state at which it applies");
  EXPECT_EQ(changes_fault(R"({"step": -1})"), "f:2:10: \"step\" must be the number of a state, 0 or more");
  EXPECT_THAT(
      changes_fault("{\"step\": 9}, {\"step\": 8}"),
      HasSubstr(
          "f:2:23: changes must be in ascending order of \"step\"; the change before this one has step 9"));
  EXPECT_THAT(changes_fault(R"({"step": 9})", 20), HasSubstr("f:2:10: lies before state 20"));
  EXPECT_EQ(changes_fault(R"({"step": 0}, {"step": 9})", 20), "") << "a list from state 0";
  EXPECT_THAT(changes_fault(R"({"step": 1, "bodis": 5})"), HasSubstr("did you mean \"bodies\"?"));
  EXPECT_EQ(changes_fault(R"({"step": 1, "remove": [122]})"),
            "f:2:24: body 122 does not exist; ids must be below 122");
  EXPECT_EQ(changes_fault(R"({"step": 1, "bodies": 20, "remove": [22]})"),
            "f:2:38: body 22 does not exist; ids must be below 22");
  EXPECT_EQ(changes_fault(R"({"step": 1, "remove": [3, 3]})"),
            "f:2:27: body 3 appears twice in this list; list it once");
  EXPECT_THAT(changes_fault(R"({"step": 1, "remove": [1.5]})"),
              HasSubstr("f:2:24: \"remove\" must be a list of ids"));
  EXPECT_EQ(changes_fault(R"({"step": 1, "freeze": [5, 121]})"), "");
  EXPECT_EQ(changes_fault(R"({"step": 1, "freeze": [122]})"),
            "f:2:24: body 122 does not exist; ids must be below 122");
  EXPECT_EQ(changes_fault(R"({"step": 1, "freeze": [3, 3]})"),
            "f:2:27: body 3 appears twice in this list; list it once");
  EXPECT_THAT(changes_fault(R"({"step": 1, "freeze": ["3"]})"),
              HasSubstr("f:2:24: \"freeze\" must be a list of ids"));
  EXPECT_EQ(changes_fault(R"({"step": 1, "add": [{"motion": "static"}]}, {"step": 2, "freeze": [122]})"),
            "f:2:68: body 122 is not dynamic; only dynamic bodies can be frozen");
  EXPECT_THAT(changes_fault(R"({"step": 1, "add": [{"radius": 1}, {"radius": -1}]})"),
              HasSubstr("f:2:47: add[1].radius: must lie in"));
  EXPECT_THAT(changes_fault(R"({"step": 1, "add": [{"radius": 1, "material": "wood"}]})"),
              HasSubstr("f:2:47: unknown material \"wood\""));
  EXPECT_THAT(changes_fault(R"({"step": 1, "add": [{"radius": 1e-9, "mass": 1, "position": [0, 0, 1e10]}]})"),
              HasSubstr("f:2:68: add[0].position[2]: must lie in"));
  EXPECT_THAT(changes_fault(R"({"step": 1, "solver": "impulse"})"), HasSubstr("f:2:23: "));
  EXPECT_THAT(changes_fault(R"({"step": 1, "time_step": 0})"), HasSubstr("f:2:26: time_step: must lie in"));
  EXPECT_THAT(changes_fault(R"({"step": 1, "threads": 2000})"),
              HasSubstr("f:2:24: \"threads\" must be \"auto\" or a whole number from 1 to 1024"));
  EXPECT_THAT(changes_fault(R"({"step": 1, "broad_phase": "lbvh"})"),
              HasSubstr("f:2:28: unknown broad phase"));
  EXPECT_THAT(changes_fault(R"({"step": 1, "seed": 4})"),
              HasSubstr("f:2:1: other bodies or another box need a restart"));
  EXPECT_THAT(changes_fault(R"({"step": 1, "bodies": 4})", 0, false),
              HasSubstr("f:2:23: \"bodies\" needs a scene with one generator; this one has none"));
  EXPECT_THAT(changes_fault(R"({"step": 1, "effects": ["friction"]})"),
              HasSubstr("f:2:24: effects: must contain rotation"));
}

}  // namespace
}  // namespace collidoscope

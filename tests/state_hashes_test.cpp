// Hashes of the whole state, computed where the world is. They depend on every number that later states
// depend on, and on nothing else: not on the executor, threads, or on how the state was reached.

#include <gtest/gtest.h>

#include <functional>
#include <thread>

#include "sim_cuda/run/run_state.h"
#include "sim_cuda/world.h"
#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

class StateHashesOf : public OnEachExecutor {};
ON_EACH_EXECUTOR(StateHashesOf);

/// Scenes that together have every kind of warm-start data.
const std::vector<const char*> hashed_scenes{"rolling",     "orbits",     "carousel",      "wrecking_ball",
                                             "bridge",      "sleepers",   "spinning_top",  "tumbling_mesh",
                                             "rolling_out", "marble_run", "newtons_cradle"};

struct StateEdit {
  const char* name;
  std::function<bool(RunState&)> apply;  ///< false: the state has no such number
  bool of_bodies = false;
};

template <class List, class Change>
bool edit_last(List& list, const Change& change) {
  if (list.empty()) return false;
  change(list.back());
  return true;
}

const std::vector<StateEdit> state_edits{
    {"position", [](RunState& s) { return edit_last(s.bodies.position, [](auto& x) { x.x() += 1; }); }, true},
    {"velocity", [](RunState& s) { return edit_last(s.bodies.velocity, [](auto& v) { v.y() += 1; }); }, true},
    {"contact impulse",
     [](RunState& s) { return edit_last(s.warm_start.contacts, [](auto& c) { c.impulse += 1; }); }},
    {"contact body", [](RunState& s) { return edit_last(s.warm_start.contacts, [](auto& c) { c.b -= 1; }); }},
    {"friction", [](RunState& s) { return edit_last(s.warm_start.friction, [](auto& f) { f[2] += 1; }); }},
    {"wall", [](RunState& s) { return edit_last(s.warm_start.walls, [](auto& w) { w.back() += 1; }); }},
    {"wall friction",
     [](RunState& s) { return edit_last(s.warm_start.wall_friction, [](auto& f) { f[1] += 1; }); }},
    {"rolling", [](RunState& s) { return edit_last(s.warm_start.rolling, [](auto& f) { f[0] += 1; }); }},
    {"wall rolling",
     [](RunState& s) { return edit_last(s.warm_start.wall_rolling, [](auto& f) { f[0] += 1; }); }},
    {"sleep timer",
     [](RunState& s) { return edit_last(s.warm_start.sleep_timer, [](auto& t) { t = t == 1 ? 2 : 1; }); }},
    {"joint", [](RunState& s) { return edit_last(s.warm_start.joints, [](auto& j) { j.impulse[0] += 1; }); }},
    {"joint limit",
     [](RunState& s) { return edit_last(s.warm_start.joints, [](auto& j) { j.impulse[6] += 1; }); }},
    {"loop energy",
     [](RunState& s) { return edit_last(s.warm_start.loop_energies, [](auto& e) { e[1] += 1; }); }},
    {"impulse sum",
     [](RunState& s) { return edit_last(s.static_impulses, [](auto& i) { i.push_work += 1; }); }},
};

TEST_P(StateHashesOf, TheWorldContainEveryNumber) {
  std::vector<bool> seen(state_edits.size(), false);
  for (const char* name : hashed_scenes) {
    World world(project_scene(name), options());
    world.step(20);
    const RunState state = world.state();
    const StateHashes hashes = world.hashes();
    EXPECT_EQ(hashes.bodies, world.state_hash()) << name;
    EXPECT_NE(hashes.full, 0u) << name;
    for (std::size_t k = 0; k < state_edits.size(); ++k) {
      RunState other = state;
      if (!state_edits[k].apply(other)) continue;
      seen[k] = true;
      world.restore(other);
      const StateHashes edited = world.hashes();
      EXPECT_EQ(edited.bodies != hashes.bodies, state_edits[k].of_bodies)
          << name << ": " << state_edits[k].name;
      EXPECT_NE(edited.full, hashes.full) << name << ": " << state_edits[k].name;
    }
    world.restore(state);
    EXPECT_EQ(world.hashes(), hashes) << name << ": a restored state has other arrays";
  }
  for (std::size_t k = 0; k < state_edits.size(); ++k)
    EXPECT_TRUE(seen[k]) << "no scene has a number of this kind: " << state_edits[k].name;
}

/// The digits that a float angular velocity lacks (wide_spin.h).
TEST_P(StateHashesOf, TheWorldContainTheLowPartsOfAngularVelocities) {
  Scene scene = project_scene("spinning_top");
  scene.physics.precision = Precision::f32;
  World world(scene, options());
  world.step(20);
  RunState state = world.state();
  const StateHashes hashes = world.hashes();
  double& w = state.bodies.angular_velocity[0].x();
  ASSERT_NE(w, static_cast<double>(static_cast<float>(w))) << "more digits than a float has";
  w *= 1 + 1e-11;
  world.restore(state);
  EXPECT_EQ(world.hashes().bodies, hashes.bodies);
  EXPECT_NE(world.hashes().full, hashes.full);
}

TEST_P(StateHashesOf, TheWorldAreThoseOfOneThread) {
  for (const char* name : hashed_scenes) {
    RunOptions one = on_cpu();
    one.cpu_threads = 1;
    World world(project_scene(name), options()), other(project_scene(name), one);
    for (int k = 0; k < 12; ++k) {
      world.step();
      other.step();
      ASSERT_EQ(world.hashes(), other.hashes()) << name << ", state " << world.steps();
    }
  }
}

/// A state that is reached in one go, and over a copy through the host.
TEST_P(StateHashesOf, TheWorldDoNotDependOnTheWay) {
  for (const char* name : hashed_scenes) {
    World straight(project_scene(name), options());
    straight.step(10);
    const RunState half = straight.state();
    World copied(project_scene(name), options(), &half);
    EXPECT_EQ(copied.hashes(), straight.hashes()) << name;
    straight.step(10);
    copied.step(10);
    EXPECT_EQ(copied.hashes(), straight.hashes()) << name;
  }
}

/// Hashes that the steps compute are those of the state, also after lists have grown, and after changes.
TEST_P(StateHashesOf, RecordedStepsAreThoseOfTheState) {
  for (const char* name : hashed_scenes)
    for (const Solver solver : {Solver::soft_step, Solver::impulse}) {
      Scene scene = project_scene(name);
      scene.physics.solver = solver;
      if (solver == Solver::impulse) scene.physics.substeps = 2;
      if (!validate(scene).empty()) continue;  // effects that impulse does not have
      RunOptions small = options();
      small.initial_pair_capacity = 1;
      World recorded(scene, small), plain(scene, options());
      const auto compare = [&](const char* what) {
        EXPECT_EQ(recorded.hashes(), plain.hashes()) << name << ", state " << plain.steps() << ", " << what;
        EXPECT_EQ(recorded.hashes().bodies, recorded.state_hash()) << name << ", " << what;
      };
      recorded.records().record_hashes(true);
      compare("before the first step");
      for (int k = 0; k < 10; ++k) {
        recorded.step();
        plain.step();
        compare("a step");
      }
      for (World* world : {&recorded, &plain}) {
        RunState state = world->state();
        state.bodies.position[0].z() += 0.25;
        world->restore(state);
      }
      compare("restored");
      recorded.set_launch_shape({2, 7});
      recorded.step(3);
      plain.step(3);
      compare("another launch shape");
      recorded.records().record_hashes(false);
      recorded.step();
      plain.step();
      compare("no longer recorded");
    }
}

/// The second part of a copy may run when the world has gone on, on another thread.
TEST_P(StateHashesOf, ACopiedStateAreThoseWhenItWasCopied) {
  for (const char* name : hashed_scenes) {
    World world(project_scene(name), options());
    world.step(10);
    const std::uint64_t before = full_hash(world.state());
    CopiedRunState copied = world.copy_state();
    world.step(5);
    RunState completed;
    std::thread([&] { completed = copied.complete(); }).join();
    EXPECT_EQ(full_hash(completed), before) << name;
  }
}

}  // namespace
}  // namespace collidoscope

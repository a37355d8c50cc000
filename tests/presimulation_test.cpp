// Tests the variant `settled`: bodies are at rest before the first step, the result is cached, and a broken
// cache only costs time.

#include "sim_cuda/snapshot/presimulation.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <set>
#include <thread>

#include "sim_cuda/core/error.h"
#include "tests/executors.h"
#include "tests/run_program.h"
#include "tests/scenes.h"
#include "viewer/session/live_world.h"

namespace collidoscope {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A fixture with its own cache folder and recorded messages.
class Settled : public OnEachExecutor {
 protected:
  Settled() {
    if (const char* was = std::getenv("XDG_CACHE_HOME")) before_ = was;
    setenv("XDG_CACHE_HOME", cache_.path().c_str(), 1);
    set_presimulation_callbacks({[this](std::int64_t, std::int64_t) { ++told_; },
                                 [this](const std::string& line) { lines_.push_back(line); }});
  }
  ~Settled() override {
    set_presimulation_callbacks({});
    before_.empty() ? unsetenv("XDG_CACHE_HOME") : setenv("XDG_CACHE_HOME", before_.c_str(), 1);
  }
  std::set<fs::path> kept() const {
    std::set<fs::path> files;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(cache_ / "collidoscope/settled", none))
      files.insert(entry.path());
    return files;
  }
  /// Whether the construction of a world ran presimulation steps.
  bool was_made(const Scene& scene, const RunOptions& how) {
    told_ = 0;
    World world(scene, how);
    hash_ = world.state_hash();
    return told_ > 0;
  }

  TemporaryFolder cache_;
  std::string before_;
  std::vector<std::string> lines_;
  int told_ = 0;
  std::uint64_t hash_ = 0;
};
ON_EACH_EXECUTOR(Settled);

Scene pile(std::int64_t bodies, double friction = 0) {
  Scene scene = box_collider(bodies, Variant::settled);
  scene.physics.solver = Solver::soft_step;
  scene.materials[0].friction = friction;
  return scene;
}

/// Mass fraction of bodies slower than `speed`, m/s.
double share_slower_than(double speed, World& world) {
  const std::vector<Vector3d> velocity = world.bodies().velocity;
  const std::vector<double>& mass = world.initial().mass;
  double slower = 0;
  for (std::size_t body = 0; body < mass.size(); ++body)
    if (velocity[body].norm() < speed) slower += mass[body];
  return slower / std::accumulate(mass.begin(), mass.end(), 0.0);
}

TEST_P(Settled, IsAtRestBeforeItsFirstStepAndStaysThere) {
  for (const std::int64_t bodies : {1, 300, 1000})
    for (const double friction : {0.0, 0.5}) {
      if (bodies == 1000 && friction > 0) continue;
      const Scene scene = pile(bodies, friction);
      World world(scene, options());
      EXPECT_EQ(world.steps(), 0);
      const std::vector<double>& mass = world.initial().mass;
      const double at_rest = energy_at_rest(std::accumulate(mass.begin(), mass.end(), 0.0), 9.81, 5);
      const StepStats start = world.measure();
      EXPECT_LE(start.kinetic_energy, at_rest) << bodies << ' ' << friction;
      EXPECT_EQ(start.wall_impulse, 0) << "since the start";
      EXPECT_LT(start.max_penetration, 0.2);
      EXPECT_EQ(start.escaped, 0);
      EXPECT_EQ(world.initial().radius, initial_bodies(box_collider(bodies, Variant::scaled)).radius);
      world.step(60);
      // A small sphere may slip between larger ones, fall metres and bounce. For a moment it may have ten
      // times the energy at rest, from its potential energy. No body gains energy, and 95 % of the mass
      // stays.
      const StepStats end = world.measure();
      EXPECT_LE(end.energy(), start.energy() + at_rest) << bodies << ' ' << friction;
      EXPECT_GE(share_slower_than(0.25, world), 0.95) << bodies << ' ' << friction;
      EXPECT_NEAR(end.potential_energy / start.potential_energy, 1, 3e-3);
    }
  EXPECT_THAT(lines_, testing::IsEmpty());
}

TEST_P(Settled, IsMadeOnceForAllThatRunsIt) {
  const Scene scene = pile(200, 0.3);
  EXPECT_TRUE(was_made(scene, options()));
  const std::uint64_t made = hash_;
  EXPECT_EQ(kept().size(), 1u);
  RunOptions other = options();
  other.broad_phase = "uniform_grid";
  other.shape = {3, 16};
  EXPECT_FALSE(was_made(scene, other));
  EXPECT_EQ(hash_, made);
  Scene renamed = scene;
  renamed.name = "another";
  renamed.camera.up = Vector3d(0, 1, 0);
  EXPECT_FALSE(was_made(renamed, options()));
  fs::remove(*kept().begin());
  EXPECT_TRUE(was_made(scene, other)) << "and again the same bits";
  EXPECT_EQ(hash_, made);
  for (int kind = 0; kind < 4; ++kind) {
    Scene changed = scene;
    if (kind == 0) changed.generators[0].seed = 2;
    if (kind == 1) changed.materials[0].restitution = 0.5;
    if (kind == 2) changed.generators[0].count = 201;
    if (kind == 3) changed.physics.gravity.z() = -9.8;
    EXPECT_TRUE(was_made(changed, options())) << kind;
  }
  EXPECT_EQ(kept().size(), 5u);
  EXPECT_THAT(lines_, testing::IsEmpty());
}

TEST_P(Settled, InSlicesItComesToTheSameState) {
  const Scene scene = pile(200, 0.3);
  ASSERT_TRUE(was_made(scene, options()));
  const std::uint64_t made = hash_;
  for (const bool known : {true, false}) {
    if (!known) fs::remove(*kept().begin());
    Presimulation presimulation(scene, options());
    std::int64_t slices = 0;
    while (!presimulation.done()) {
      EXPECT_EQ(presimulation.steps(), slices);
      EXPECT_LT(presimulation.steps(), presimulation.max_steps());
      presimulation.advance(0);
      ++slices;
    }
    EXPECT_EQ(slices > 0, !known);
    const RunState rest = presimulation.take();
    World world(scene, options(), &rest);
    EXPECT_EQ(world.steps(), 0);
    EXPECT_EQ(world.state_hash(), made);
    EXPECT_EQ(kept().size(), 1u);
  }
}

TEST_P(Settled, ASceneOfImpulsesSettlesBySoftSteps) {
  Scene scene = pile(200);
  EXPECT_TRUE(was_made(scene, options()));
  const std::uint64_t soft = hash_;
  scene.physics.solver = Solver::impulse;
  scene.physics.substeps = 1;
  EXPECT_FALSE(was_made(scene, options()));
  EXPECT_EQ(hash_, soft);
  World world(scene, options());
  world.step(3);
  EXPECT_EQ(world.measure().non_finite, 0);
}

TEST_P(Settled, ABrokenCacheCostsTimeAlone) {
  const Scene scene = pile(100);
  EXPECT_TRUE(was_made(scene, options()));
  const std::uint64_t made = hash_;
  const fs::path file = *kept().begin();
  const auto size = fs::file_size(file);
  fs::resize_file(file, size / 2);
  EXPECT_TRUE(was_made(scene, options()));
  EXPECT_EQ(hash_, made);
  ASSERT_EQ(lines_.size(), 1u);
  EXPECT_THAT(lines_[0], HasSubstr("is damaged"));
  EXPECT_EQ(fs::file_size(file), size) << "and is whole again";
  setenv("XDG_CACHE_HOME", "/dev/null/nowhere", 1);
  EXPECT_TRUE(was_made(scene, options()));
  EXPECT_EQ(hash_, made);
  ASSERT_EQ(lines_.size(), 2u);
  EXPECT_THAT(lines_[1], HasSubstr("is not cached"));
}

TEST_P(Settled, WhatNeverRestsEndsWithALine) {
  Scene scene = pile(40);
  scene.physics.gravity.z() = -1e6;  // bodies cross the whole box in a step
  EXPECT_TRUE(was_made(scene, options()));
  ASSERT_EQ(lines_.size(), 1u);
  EXPECT_THAT(lines_[0], HasSubstr("not at rest after 9 steps: the kinetic energy is"));
}

TEST_P(Settled, TheWindowSettlesAnewOnlyWhereTheRunStartsAnew) {
  LiveWorld live(pile(100), options());
  live.step(false);
  Settings request = live.settings();
  told_ = 0;
  request.material.restitution = 0.2;
  EXPECT_EQ(live.apply(request), "");
  EXPECT_EQ(live.world().steps(), 1);
  EXPECT_TRUE(live.edited());
  EXPECT_EQ(told_, 0);
  request.generator.count = 120;
  EXPECT_THAT(live.apply(request), HasSubstr("restarted"));
  EXPECT_EQ(live.world().steps(), 0);
  EXPECT_GT(told_, 0);
  request.generator.variant = Variant::scaled;
  live.apply(request);
  EXPECT_EQ(live.stats().kinetic_energy, 0);
}

TEST(SettledProgram, TwoAtOnceAndOneWithoutGravity) {
  const TemporaryFolder folder;
  setenv("XDG_CACHE_HOME", folder.path().c_str(), 1);
  const std::vector<std::string> run{"run",      "box_collider", "--variant", "settled",
                                     "--bodies", "150",          "--steps",   "5",
                                     "--solver", "soft_step",    "--json",    "-"};
  Outcome outcomes[3];
  {
    std::vector<std::thread> programs;
    for (int k = 0; k < 2; ++k) programs.emplace_back([&, k] { outcomes[k] = run_headless(run); });
    for (std::thread& program : programs) program.join();
  }
  outcomes[2] = run_headless(run);
  const auto hash = [](const Outcome& outcome) {
    return outcome.out.substr(outcome.out.find("state_hash"), 32);
  };
  for (const Outcome& outcome : outcomes) {
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(hash(outcome), hash(outcomes[0]));
    EXPECT_THAT(outcome.out, HasSubstr("\"settled\""));
  }
  const Outcome floating =
      run_headless({"run", "box_collider", "--variant", "settled", "--gravity", "0,0,0"});
  EXPECT_EQ(floating.status, 2);
  EXPECT_EQ(floating.err, "--variant: must not be settled without gravity: no body would come to rest\n");
  unsetenv("XDG_CACHE_HOME");
}

}  // namespace
}  // namespace collidoscope

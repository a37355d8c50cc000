// Tests the Bullet baseline of `bench solvers` against closed forms. Bullet must simulate the same scene as
// our solvers.

#include "headless/bench/bullet_baseline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/run_program.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

World cpu_world(const Scene& scene) {
  RunOptions options;
  options.executor = ExecutorKind::cpu;
  return World(scene, options);
}

TEST(BulletBaseline, FallsRestsAndSlides) {
  if (!has_bullet()) return;
  Scene scene = empty_space();
  scene.physics.gravity = Vector3d(0, 0, -9.81);
  scene.physics.solver = Solver::soft_step;
  scene.materials[0].restitution = 0;
  scene.materials[0].friction = 0.3;
  scene.obstacles.push_back({});
  scene.bodies = {sphere(1, Vector3d(0, 0, 100), Vector3d(1, 0, 0)), sphere(1, Vector3d(10, 0, 1)),
                  sphere(1, Vector3d(20, 0, 1), Vector3d(7, 0, 0))};
  World world = cpu_world(scene);
  BulletBaseline bullet(world, world.bodies(), {.substeps = 4, .iterations = 10});
  for (int k = 0; k < 60; ++k) bullet.step();  // 2 s
  const BodyStates states = bullet.bodies();
  ASSERT_EQ(states.position.size(), 3u);
  EXPECT_NEAR(states.velocity[0].z(), -9.81 * 2, 1e-3);
  EXPECT_NEAR(states.velocity[0].x(), 1, 1e-5);
  EXPECT_NEAR(states.position[0].z(), 100 - 9.81 * 2 * 2 / 2, 0.1);  // first order: error g t h / 2
  EXPECT_NEAR(states.position[1].z(), 1, 0.02);
  EXPECT_NEAR(states.velocity[1].norm(), 0, 1e-2);
  // Sliding has turned into rolling at 5/7 of the speed, as in our solvers.
  EXPECT_NEAR(states.velocity[2].x(), 5, 0.1);
  EXPECT_NEAR(states.angular_velocity[2].y(), 5, 0.1);
}

TEST(BulletBaseline, IsHeldByTheBoxAndKeepsTheLawOfRestitution) {
  if (!has_bullet()) return;
  Scene scene = empty_space();
  scene.box = Box{{-10, -10, -10}, {10, 10, 10}};
  scene.materials[0].restitution = 0.25;
  scene.bodies = {sphere(1, Vector3d(0, 0, 0), Vector3d(8, 0, 0))};
  World world = cpu_world(scene);
  BulletBaseline bullet(world, world.bodies(), {.substeps = 2, .iterations = 10});
  for (int k = 0; k < 60; ++k) bullet.step();
  EXPECT_NEAR(bullet.bodies().velocity[0].x(), -2, 1e-3);
}

TEST(BenchSolvers, OneRowForEachAndARatio) {
  const TemporaryFolder folder;
  const std::string at = folder.path().string() + "/";
  const Outcome run = run_headless({"bench", "solvers", "box_collider", "--bodies", "100", "--solver",
                                    "soft_step", "--repeats", "4", "--json", at + "r.json", "--csv",
                                    at + "r.csv", "--markdown", at + "r.md"});
  ASSERT_EQ(run.status, 0) << run.err;
  const nlohmann::json report = nlohmann::json::parse(text_of(at + "r.json"));
  ASSERT_EQ(report["rows"].size(), has_bullet() ? 4u : 2u);
  EXPECT_EQ(report["steps"], 24);
  EXPECT_EQ(report["threads"], 1);
  EXPECT_EQ(report["rows"][0]["solver"], "soft_step");
  EXPECT_EQ(report["rows"][0]["ratio"]["median"], 1);
  EXPECT_EQ(report["rows"][1]["solver"], "impulse");
  for (const nlohmann::json& row : report["rows"]) {
    EXPECT_GT(row["step_ms"]["median"], 0);
    EXPECT_LE(row["ratio"]["p5"], row["ratio"]["median"]);
    EXPECT_GE(row["overlap_rms"], 0);
    EXPECT_EQ(row["escaped"], 0);
  }
  EXPECT_THAT(text_of(at + "r.md"), testing::HasSubstr("| `soft_step` | 4 substeps, 1 iteration |"));
  EXPECT_THAT(text_of(at + "r.csv"), testing::StartsWith("solver,settings,step_ms,"));
  const Outcome refused = run_headless({"bench", "solvers", "rolling_out"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, testing::HasSubstr("bench solvers supports only spheres, planes and friction"));
}

}  // namespace
}  // namespace collidoscope

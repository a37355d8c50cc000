// Tests the bodies that a scene generates: masses, inertia and axes against formulas, and the required
// effects.
#include "sim_cuda/scene/initial_bodies.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>

#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/box_collider.h"
#include "sim_cuda/scene/scene_file.h"
#include "tests/scenes.h"
#include "tests/test_files.h"

namespace collidoscope {
namespace {

std::string fault_of(const Scene& scene) {
  try {
    initial_bodies(scene);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(InitialBodies, AnEmptySceneHasNone) {
  const InitialBodies bodies = initial_bodies(Scene{});
  EXPECT_EQ(bodies.size(), 0u);
  EXPECT_FALSE(bodies.box);
}

TEST(InitialBodies, WhatIsDefaultIsNotStored) {
  Scene scene;
  scene.box = Box{};
  scene.bodies.resize(2);
  scene.generators.push_back({.count = 5});
  const InitialBodies bodies = initial_bodies(scene);
  EXPECT_EQ(bodies.size(), 7u);
  EXPECT_EQ(bodies.mass.size(), 7u);
  EXPECT_TRUE(bodies.velocity.empty() && bodies.angular_velocity.empty() && bodies.orientation.empty());
  EXPECT_TRUE(bodies.inertia.empty() && bodies.material.empty() && bodies.mesh.empty() &&
              bodies.meshes.empty());
}

TEST(InitialBodies, OneThatDiffersFillsTheArray) {
  Scene scene;
  scene.box = Box{};
  scene.materials.push_back({.name = "light", .density = 1});
  scene.bodies.resize(2);
  scene.bodies[1].mass = 10;
  scene.bodies[1].inertia = Vector3d(3, 4, 5);
  scene.bodies[1].angular_velocity = {0, 0, 2};
  scene.generators.push_back({.count = 2});
  scene.generators.push_back({.count = 2, .seed = 2, .speed_max = 3, .material = 1});
  scene.generators.push_back({.count = 1, .seed = 3});
  const InitialBodies bodies = initial_bodies(scene);
  ASSERT_EQ(bodies.size(), 7u);
  ASSERT_EQ(bodies.velocity.size(), 7u);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(bodies.velocity[i].isZero(0), i != 4 && i != 5) << i;
  ASSERT_EQ(bodies.angular_velocity.size(), 7u);
  EXPECT_EQ(bodies.angular_velocity[1], Vector3d(0, 0, 2));
  EXPECT_EQ(bodies.angular_velocity[6], Vector3d(0, 0, 0));
  EXPECT_THAT(bodies.material, testing::ElementsAre(0, 0, 0, 0, 1, 1, 0));
  ASSERT_EQ(bodies.inertia.size(), 7u);
  EXPECT_EQ(bodies.inertia[1], Vector3d(3, 4, 5));
  for (const std::size_t i : {0u, 2u, 5u, 6u}) {
    EXPECT_DOUBLE_EQ(bodies.inertia[i][1], 0.4 * bodies.mass[i] * bodies.radius[i] * bodies.radius[i]);
  }
  EXPECT_TRUE(bodies.orientation.empty());
}

TEST(InitialBodies, MassIsDensityTimesVolume) {
  Scene scene;
  scene.box = Box{};
  scene.bodies.resize(1);
  scene.bodies[0].radius = 2;
  scene.generators.push_back({.count = 1000});
  const InitialBodies bodies = initial_bodies(scene);
  EXPECT_DOUBLE_EQ(bodies.mass[0], 1000 * 4.0 / 3 * std::numbers::pi * 8);
  for (std::size_t i = 1; i < bodies.size(); ++i) {
    const double r = bodies.radius[i];
    EXPECT_EQ(bodies.mass[i], static_cast<float>(1000 * (4.0 / 3 * std::numbers::pi * (r * r * r)))) << i;
    for (const double x : {r, bodies.position[i][0], bodies.position[i][1], bodies.position[i][2]}) {
      EXPECT_EQ(x, static_cast<float>(x));  // float and double runs start from equal values
    }
  }
}

TEST(InitialBodies, ScaledReplacesTheBox) {
  Scene scene;
  scene.box = Box{{10, 10, 10}, {20, 20, 20}};
  scene.generators.push_back({.count = 5000, .variant = Variant::scaled});
  const InitialBodies bodies = initial_bodies(scene);
  EXPECT_EQ(bodies.box->max[0], 10 + scaled_side(5000, 5));
  double highest = 0;
  for (const Vector3d& position : bodies.position) highest = std::max(highest, position.maxCoeff());
  EXPECT_GT(highest, 100);
}

TEST(InitialBodies, AMeshBringsMassAndAxes) {
  Scene scene = read_scene(project_file("assets/scenes/tumbling_mesh.json").string());
  const InitialBodies bodies = initial_bodies(scene);
  ASSERT_EQ(bodies.size(), 4u);
  ASSERT_EQ(bodies.meshes.size(), 2u);  // two bodies share a file
  EXPECT_THAT(bodies.mesh, testing::ElementsAre(1, 2, 1, 0));
  const Mesh& block = bodies.meshes[0];
  EXPECT_NEAR(bodies.mass[0], 4000, 1e-9);
  EXPECT_EQ(bodies.radius[0], block.bounding_radius);
  EXPECT_TRUE(bodies.inertia[0].isApprox(block.inertia_per_density * 1000, 1e-14));
  // The corner (0, 0, 0) of the file: the scene's orientation applies after the mesh's principal axes.
  const Vector3d corner = scene.bodies[2].orientation * Vector3d(-block.center);
  EXPECT_TRUE((bodies.orientation[2] * block.vertices[0]).isApprox(corner, 1e-14));

  scene.bodies[0].mass = 8000;
  EXPECT_TRUE(initial_bodies(scene).inertia[0].isApprox(block.inertia_per_density * 2000, 1e-14));
}

TEST(InitialBodies, WhoIsLeftOutIsMissedByNobodyElse) {
  Scene scene = box_collider(50);
  scene.generators[0].speed_max = 2;
  scene.generators[0].spawn = Spawn::apart;
  scene.bodies = {sphere(1, Vector3d(20, 20, 20))};
  const InitialBodies all = initial_bodies(scene);
  scene.generators[0].excluded = {0, 7, 49};
  scene.extra_bodies = {sphere(2, Vector3d(60, 60, 60), Vector3d(0, 0, 3))};
  scene.extra_bodies[0].angular_velocity = Vector3d(0, 1, 0);
  const InitialBodies some = initial_bodies(scene);
  ASSERT_EQ(some.size(), 1u + 47u + 1u);
  std::size_t at = 1;
  for (std::size_t number = 0; number < 50; ++number) {
    if (number == 0 || number == 7 || number == 49) continue;
    EXPECT_EQ(some.position[at], all.position[1 + number]);
    EXPECT_EQ(some.velocity[at], all.velocity[1 + number]);
    EXPECT_EQ(some.mass[at], all.mass[1 + number]);
    EXPECT_EQ(some.radius[at++], all.radius[1 + number]);
  }
  EXPECT_EQ(some.radius[48], 2);
  EXPECT_EQ(some.velocity[48], Vector3d(0, 0, 3));
  ASSERT_EQ(some.angular_velocity.size(), 49u);
  EXPECT_EQ(some.angular_velocity[48], Vector3d(0, 1, 0));
  EXPECT_TRUE(some.orientation.empty());
  EXPECT_TRUE(some.inertia.empty());
}

TEST(InitialBodies, RefusesWhatCannotBe) {
  Scene scene;
  scene.name = "s";
  scene.bodies.resize(1);
  scene.bodies[0].radius = -1;
  EXPECT_EQ(fault_of(scene), "s: bodies[0].radius: must lie in [1e-09, 1e+09] m");

  scene.bodies[0].radius = 1e9;
  scene.file = "a.json";
  EXPECT_THAT(fault_of(scene),
              testing::StartsWith("a.json: bodies[0]: its mass would be 4.19e+30 kg (density times"));

  scene.bodies[0].radius = 1e-8;
  EXPECT_EQ(fault_of(scene), "none");
  scene.bodies[0].angular_velocity = {1, 0, 0};
  EXPECT_THAT(fault_of(scene),
              testing::StartsWith("a.json: bodies[0]: its moment of inertia would be 1.68e-37 kg m^2"));

  scene.bodies[0] = Body{};
  scene.bodies[0].shape = Shape::mesh;
  scene.bodies[0].mesh = "missing.obj";
  EXPECT_THAT(fault_of(scene),
              testing::StartsWith("a.json: bodies[0].mesh: missing.obj: cannot be opened (No such file or"));

  scene.directory = project_file("assets/scenes/meshes").string();
  scene.bodies[0].mesh = "l_block.obj";
  scene.box = Box{{0, 0, 0}, {3, 3, 3}};
  EXPECT_THAT(fault_of(scene),
              testing::StartsWith("a.json: bodies[0]: its bounding sphere of 1.97 m radius does not fit"));
}

TEST(InitialBodies, EffectsThatTheSceneCallsFor) {
  Scene scene;
  scene.bodies.resize(2);
  EXPECT_EQ(required_effects(scene, initial_bodies(scene)), (Effects{.gravity = true, .rotation = false}));
  scene.physics.gravity.setZero();
  EXPECT_EQ(required_effects(scene, initial_bodies(scene)), (Effects{.gravity = false, .rotation = false}));
  scene.bodies[1].angular_velocity = {0, 1e-3, 0};
  EXPECT_EQ(required_effects(scene, initial_bodies(scene)), (Effects{.gravity = false, .rotation = true}));
  scene.bodies[1].angular_velocity.setZero();
  scene.physics.solver = Solver::soft_step;
  scene.materials[0].friction = 0.1;
  EXPECT_EQ(required_effects(scene, initial_bodies(scene)), (Effects{.rotation = true, .friction = true}));
  scene.materials[0] = {.rolling_resistance = 0.1};
  EXPECT_EQ(required_effects(scene, initial_bodies(scene)),
            (Effects{.rotation = true, .friction = true, .rolling_resistance = true}));
  scene.materials[0] = {};
  scene.physics.drag.density = 1.2;
  EXPECT_EQ(required_effects(scene, initial_bodies(scene)), (Effects{.drag = true}));
  scene.physics.drag.coefficient = 0;
  EXPECT_EQ(required_effects(scene, initial_bodies(scene)), Effects{});
  scene.physics.attractors.resize(1);
  EXPECT_EQ(required_effects(scene, initial_bodies(scene)), (Effects{.attractor = true}));
}

// Tests that the scenes of the project load.
TEST(Scenes, AllOfThemLoad) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(project_file("assets/scenes"))) {
    if (entry.path().extension() != ".json") continue;
    SCOPED_TRACE(entry.path());
    const Scene scene = read_scene(entry.path().string());
    EXPECT_NE(scene.name, "unnamed");
    const InitialBodies bodies = initial_bodies(scene);
    for (std::size_t i = 0; bodies.box && i < bodies.size(); ++i) {
      EXPECT_TRUE(((bodies.position[i].array() - bodies.radius[i]) >= bodies.box->min.array()).all()) << i;
      EXPECT_TRUE(((bodies.position[i].array() + bodies.radius[i]) <= bodies.box->max.array()).all()) << i;
    }
    ++count;
  }
  EXPECT_GE(count, 18);
}

TEST(Scenes, TheBoxColliderIsTheOneOfThePaper) {
  const Scene scene = read_scene(project_file("assets/scenes/box_collider.json").string());
  const InitialBodies bodies = initial_bodies(scene);
  ASSERT_EQ(bodies.size(), 2000u);
  double volume = 0;
  for (const double r : bodies.radius) volume += 4.0 / 3 * std::numbers::pi * r * r * r;
  EXPECT_NEAR(volume / 1e6, 0.26, 0.01);
  EXPECT_EQ(scene.physics.time_step, 1.0 / 30);
}

}  // namespace
}  // namespace collidoscope

// Tests scene files: the value and the default of each field, files that cannot be read, and keys that were
// renamed.

#include "sim_cuda/scene/scene_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "sim_cuda/core/error.h"
#include "tests/scene_text.h"
#include "tests/test_files.h"

namespace collidoscope {
namespace {

using testing::StartsWith;

TEST(SceneFile, DefaultsAreTheStructs) {
  const Scene scene = parse_scene(scene_head + "\"bodies\": []}", "s");
  const Scene expected;
  EXPECT_EQ(write_scene(scene), write_scene(expected));
  EXPECT_EQ(scene.physics.time_step, 1.0 / 30);
  EXPECT_EQ(scene.physics.time_step.steps_per_second(), std::nullopt);
  EXPECT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.materials[0].restitution, 0.8);
}

TEST(SceneFile, EveryFieldIsRead) {
  const Scene scene = parse_scene(scene_head + R"(
    "name": "all", // comment
    "box": {"min": [-1, -2, -3], "max": [1, 2, 3]},
    "gravity": [0.5, 0, -1.6], "drag": {"viscosity": 1e-3, "density": 998, "coefficient": 0.5},
    "attractors": [{"position": [1, 2, 4], "strength": -8, "softening": 16}],
    "steps_per_second": 240, "substeps": 4, "iterations": 7, "solver": "soft_step",
    "integrator": "velocity_verlet", "rotation_update": "lie_group", "precision": "f64", "effects": ["rotation"], "restitution_threshold": 0.25,
    "materials": {"steel": {"density": 7850, "restitution": 0.6, "friction": 0, "rolling_resistance": 0},
                  "default": {"density": 2}},
    "bodies": [{"shape": "sphere", "radius": 0.5, "position": [1, 2, 3], "orientation": [0, 0, 2, 0],
                "velocity": [4, 5, 6], "angular_velocity": [7, 8, 9], "mass": 10, "inertia": [1, 2, 3],
                "material": "steel"},
               {"shape": "mesh", "motion": "kinematic", "mesh": "a/b.obj"}],
    "generators": [{"kind": "box_collider", "count": 1e1, "radius_max": 0.25, "variant": "equal", "spawn": "apart",
                    "seed": 18446744073709551615, "speed_max": 2, "material": "steel"}],
    "obstacles": [{"shape": "box", "center": [1, 2, 3], "size": [4, 5, 6], "orientation": [0, 2, 0, 0], "material": "steel"},
                  {"shape": "plane", "normal": [0, 0, 3], "offset": -4, "material": "steel"}],
    "joints": [{"kind": "distance", "a": 0, "b": 1, "anchor_a": [1, 2, 3], "anchor_b": [4, 5, 6], "min_length": 0.5,
                "max_length": 2, "collide": true},
               {"kind": "spring", "a": 2, "b": "world", "anchor_b": [7, 8, 9], "length": 3, "frequency": 4,
                "damping_ratio": 0.5},
               {"kind": "hinge", "a": 1, "b": 0, "axis": [0, 3, 4], "limits": [-90, 45]}, {"kind": "ball", "a": 3, "b": 0}],
    "camera": {"position": [9, 9, 9], "target": [1, 1, 1], "up": [0, 1, 0], "vertical_field_of_view": 55}})",
                                  "s", "dir");
  EXPECT_EQ(scene.name, "all");
  EXPECT_EQ(scene.directory, "dir");
  EXPECT_EQ(scene.file, "s");
  EXPECT_EQ(scene.box->min, Vector3d(-1, -2, -3));
  EXPECT_EQ(scene.box->max, Vector3d(1, 2, 3));
  const Physics& p = scene.physics;
  EXPECT_EQ(p.gravity, Vector3d(0.5, 0, -1.6));
  EXPECT_EQ(p.drag.viscosity, 1e-3);
  EXPECT_EQ(p.drag.density, 998);
  EXPECT_EQ(p.drag.coefficient, 0.5);
  EXPECT_EQ(p.attractors.at(0).position, Vector3d(1, 2, 4));
  EXPECT_EQ(p.attractors.at(0).strength, -8);
  EXPECT_EQ(p.attractors.at(0).softening, 16);
  EXPECT_EQ(p.time_step, 1.0 / 240);
  EXPECT_EQ(p.time_step.steps_per_second(), 240);
  EXPECT_EQ(p.substeps, 4);
  EXPECT_EQ(p.iterations, 7);
  EXPECT_EQ(p.integrator, Integrator::velocity_verlet);
  EXPECT_EQ(p.rotation_update, RotationUpdate::lie_group);
  EXPECT_EQ(p.precision, Precision::f64);
  EXPECT_EQ(*p.effects, (Effects{.gravity = false, .rotation = true}));
  EXPECT_EQ(p.restitution_threshold, 0.25);
  ASSERT_EQ(scene.materials.size(), 2u);
  EXPECT_EQ(scene.materials[0].name, "default");
  EXPECT_EQ(scene.materials[0].density, 2);
  EXPECT_EQ(scene.materials[1].name, "steel");
  EXPECT_EQ(scene.materials[1].restitution, 0.6);
  const Body& body = scene.bodies.at(0);
  EXPECT_EQ(body.radius, 0.5);
  EXPECT_EQ(body.position, Vector3d(1, 2, 3));
  EXPECT_EQ(body.orientation.coeffs(), Quaterniond(0, 0, 1, 0).coeffs());
  EXPECT_EQ(body.velocity, Vector3d(4, 5, 6));
  EXPECT_EQ(body.angular_velocity, Vector3d(7, 8, 9));
  EXPECT_EQ(body.mass, 10.0);
  EXPECT_EQ(*body.inertia, Vector3d(1, 2, 3));
  EXPECT_EQ(body.material, 1);
  EXPECT_EQ(scene.bodies.at(0).motion, Motion::dynamic);
  EXPECT_EQ(scene.bodies.at(1).motion, Motion::kinematic);
  EXPECT_EQ(scene.bodies.at(1).shape, Shape::mesh);
  EXPECT_EQ(scene.bodies.at(1).mesh, "a/b.obj");
  const BoxCollider& generator = scene.generators.at(0);
  EXPECT_EQ(generator.count, 10);
  EXPECT_EQ(generator.radius_max, 0.25);
  EXPECT_EQ(generator.variant, Variant::equal);
  EXPECT_EQ(generator.spawn, Spawn::apart);
  EXPECT_EQ(generator.seed, ~std::uint64_t{0});
  EXPECT_EQ(generator.speed_max, 2);
  EXPECT_EQ(generator.material, 1);
  EXPECT_EQ(scene.boxes.at(0).center, Vector3d(1, 2, 3));
  EXPECT_EQ(scene.boxes.at(0).size, Vector3d(4, 5, 6));
  EXPECT_EQ(scene.boxes.at(0).orientation.coeffs(), Quaterniond(0, 1, 0, 0).coeffs());
  EXPECT_EQ(scene.boxes.at(0).material, 1);
  EXPECT_EQ(scene.obstacles.at(0).normal, Vector3d(0, 0, 1));
  EXPECT_EQ(scene.obstacles.at(0).offset, -4);
  EXPECT_EQ(scene.obstacles.at(0).material, 1);
  const Joint& rope = scene.joints.at(0);
  EXPECT_EQ(rope.kind, JointKind::distance);
  EXPECT_EQ(rope.a, 0);
  EXPECT_EQ(rope.b, 1);
  EXPECT_EQ(rope.anchor_a, Vector3d(1, 2, 3));
  EXPECT_EQ(rope.anchor_b, Vector3d(4, 5, 6));
  EXPECT_EQ(rope.length, std::nullopt);
  EXPECT_EQ(rope.min_length, 0.5);
  EXPECT_EQ(rope.max_length, 2);
  EXPECT_TRUE(rope.collide);
  EXPECT_EQ(scene.joints.at(1).kind, JointKind::spring);
  EXPECT_EQ(scene.joints[1].b, std::nullopt);
  EXPECT_EQ(scene.joints[1].length, 3);
  EXPECT_EQ(scene.joints[1].frequency, 4);
  EXPECT_EQ(scene.joints[1].damping_ratio, 0.5);
  EXPECT_FALSE(scene.joints[1].collide);
  EXPECT_EQ(scene.joints.at(2).kind, JointKind::hinge);
  EXPECT_TRUE(scene.joints[2].axis.isApprox(Vector3d(0, 0.6, 0.8), 1e-15));
  EXPECT_EQ(scene.joints[2].limits, (std::array{-90.0, 45.0}));
  EXPECT_EQ(scene.joints.at(3).kind, JointKind::ball);
  EXPECT_EQ(scene.joints[3].anchor_b, std::nullopt);
  EXPECT_EQ(*scene.camera.position, Vector3d(9, 9, 9));
  EXPECT_EQ(*scene.camera.target, Vector3d(1, 1, 1));
  EXPECT_EQ(scene.camera.up, Vector3d(0, 1, 0));
  EXPECT_EQ(scene.camera.vertical_field_of_view, 55);
}

TEST(SceneFile, NormalisingHugeAndTinyDirections) {
  const Scene scene =
      parse_scene(scene_head + R"("obstacles": [{"shape": "plane", "normal": [3e300, 0, 4e300]},
      {"shape": "plane", "normal": [0, 3e-300, 4e-300]}], "bodies": [{"orientation": [3e-200, 0, 4e-200, 0]}]})",
                  "s");
  EXPECT_TRUE(scene.obstacles[0].normal.isApprox(Vector3d(0.6, 0, 0.8), 1e-15));
  EXPECT_TRUE(scene.obstacles[1].normal.isApprox(Vector3d(0, 0.6, 0.8), 1e-15));
  EXPECT_TRUE(scene.bodies[0].orientation.isApprox(Quaterniond(0.6, 0, 0.8, 0), 1e-15));
}

TEST(SceneFile, FilesThatCannotBeRead) {
  const TemporaryFolder folder;
  const auto line = [&](const std::string& file) -> std::string {
    try {
      read_scene(file);
    } catch (const InputError& error) {
      return error.what();
    }
    return "none";
  };
  const std::string missing = (folder / "none.json").string();
  EXPECT_EQ(
      line(missing),
      missing + ": cannot be opened (No such file or directory); give the path of a scene file (.json)");
  EXPECT_EQ(line(folder.path().string()),
            folder.path().string() + ": is a folder; give the path of a scene file (.json)");
  const std::string huge = (folder / "huge.json").string();
  std::ofstream(huge).put('{');
  std::filesystem::resize_file(huge, std::uintmax_t{1} << 40);  // a sparse file, refused before it is read
  EXPECT_THAT(line(huge), StartsWith(huge + ": larger than 64 MiB, the maximum size"));
  EXPECT_THAT(line("/dev/zero"), StartsWith("/dev/zero: larger than 64 MiB"));  // has no size
}

TEST(SceneFile, MeshPathsStartAtTheFile) {
  const TemporaryFolder folder;
  const std::string file = (folder / "a.json").string();
  std::ofstream(file) << write_scene(Scene{});
  const Scene scene = read_scene(file);
  EXPECT_EQ(scene.directory, folder.path().string());
  EXPECT_EQ(scene.file, file);
}

// Keys that were renamed are still read, each with a warning; what is written has the new keys.
TEST(SceneFile, OldKeysAreReadWithAWarning) {
  const std::string begin = R"({"format": "collidoscope-scene", "version": 1, "box": {},
)";
  const Scene old = parse_scene(begin + R"("guards": {"spin": 7}, "added": [{"radius": 2}],
"generators": [{"kind": "box_collider", "count": 3, "without": [1]}]})",
                                "s");
  EXPECT_EQ(old.physics.guards.value().angular_speed, 7);
  EXPECT_EQ(old.extra_bodies.size(), 1u);
  EXPECT_THAT(old.generators.at(0).excluded, testing::ElementsAre(1));
  EXPECT_THAT(
      old.warnings,
      testing::ElementsAre("s:2:12: warning: \"spin\" is now \"angular_speed\"; the old name still works",
                           testing::HasSubstr("\"extra_bodies\""), testing::HasSubstr("\"excluded\"")));
  const std::string text = write_scene(old);
  EXPECT_TRUE(parse_scene(text, "t").warnings.empty()) << text;
  EXPECT_THAT(scene_faults_of(begin + R"("guards": {"spin": -1}})"),
              testing::ElementsAre(testing::StartsWith("s:2:20: guards.angular_speed: must lie in")));
  EXPECT_THAT(scene_faults_of(begin + R"("spin": 1})"),
              testing::ElementsAre(testing::HasSubstr("unknown key \"spin\"")));
}
}  // namespace
}  // namespace collidoscope

// Tests scene files: each field with its range and default. A written file must be read back bit for bit.
// More than 400 lines: one case for each field.

#include "sim_cuda/scene/scene_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>

#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/names.h"
#include "tests/test_files.h"

namespace collidoscope {
namespace {

using testing::ElementsAre;
using testing::StartsWith;

const std::string head = "{\"format\": \"collidoscope-scene\", \"version\": 1,\n";

std::vector<std::string> faults_of(const std::string& text) {
  try {
    parse_scene(text, "s");
  } catch (const InputError& error) {
    return error.lines();
  }
  return {};
}

TEST(SceneFile, DefaultsAreTheStructs) {
  const Scene scene = parse_scene(head + "\"bodies\": []}", "s");
  const Scene expected;
  EXPECT_EQ(write_scene(scene), write_scene(expected));
  EXPECT_EQ(scene.physics.time_step, 1.0 / 30);
  EXPECT_EQ(scene.physics.time_step.steps_per_second(), std::nullopt);
  EXPECT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.materials[0].restitution, 0.8);
}

TEST(SceneFile, EveryFieldIsRead) {
  const Scene scene = parse_scene(head + R"(
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
  const Scene scene = parse_scene(head + R"("obstacles": [{"shape": "plane", "normal": [3e300, 0, 4e300]},
      {"shape": "plane", "normal": [0, 3e-300, 4e-300]}], "bodies": [{"orientation": [3e-200, 0, 4e-200, 0]}]})",
                                  "s");
  EXPECT_TRUE(scene.obstacles[0].normal.isApprox(Vector3d(0.6, 0, 0.8), 1e-15));
  EXPECT_TRUE(scene.obstacles[1].normal.isApprox(Vector3d(0, 0.6, 0.8), 1e-15));
  EXPECT_TRUE(scene.bodies[0].orientation.isApprox(Quaterniond(0.6, 0, 0.8, 0), 1e-15));
}

struct SceneFault {
  std::string text;  ///< the text after `head`, which begins on line 2
  std::string line;
};
class BadScene : public testing::TestWithParam<SceneFault> {};
TEST_P(BadScene, IsOneLineWithItsPosition) {
  EXPECT_THAT(faults_of(head + GetParam().text), ElementsAre(StartsWith(GetParam().line)));
}

INSTANTIATE_TEST_SUITE_P(
    Table, BadScene,
    testing::Values(
        // keys
        SceneFault{"\"gravty\": [0, 0, 0]}",
                   "s:2:1: unknown key \"gravty\" in a scene; did you mean \"gravity\"?"},
        SceneFault{"\"bodies\": [{\"raduis\": 1}]}",
                   "s:2:13: unknown key \"raduis\" in a body; did you mean \"radius\"?"},
        SceneFault{"\"camera\": {\"zoom\": 1}}",
                   "s:2:12: unknown key \"zoom\" in a camera; expected position, target, up or "
                   "vertical_field_of_view"},
        SceneFault{"\"name\": \"a\", \"name\": \"b\"}", "s:2:14: duplicate key \"name\""},
        // types
        SceneFault{"\"name\": 1}", "s:2:9: \"name\" must be a string, not a number"},
        SceneFault{"\"box\": []}", "s:2:8: a box must be an object, { ... }, not a list"},
        SceneFault{"\"box\": null}", "s:2:8: a box must be an object, { ... }, not null"},
        SceneFault{"\"bodies\": {}}", "s:2:11: \"bodies\" must be a list, not an object"},
        SceneFault{"\"bodies\": [7]}", "s:2:12: a body must be an object, { ... }, not a number"},
        SceneFault{"\"gravity\": -9.81}", "s:2:12: \"gravity\" must be a list of three numbers, [x, y, z]"},
        SceneFault{"\"gravity\": [0, 0]}",
                   "s:2:12: \"gravity\" must be a list of three numbers, [x, y, z], not of 2 values"},
        SceneFault{"\"gravity\": [0, \"0\", 0]}",
                   "s:2:16: \"gravity\" must be a list of three numbers, [x, y, z]; this is a string"},
        SceneFault{"\"time_step\": true}", "s:2:14: \"time_step\" must be a number, not true or false"},
        SceneFault{"\"time_step\": 1e-999}", "s:2:14: 1e-999 is too small for a double; write 0"},
        SceneFault{"\"gravity\": [0, 1e-999, 0]}", "s:2:16: 1e-999 is too small"},
        SceneFault{"\"substeps\": 1.5}", "s:2:13: \"substeps\" must be a whole number, not 1.5"},
        SceneFault{"\"materials\": []}", "s:2:14: \"materials\" must be an object of names"},
        SceneFault{"\"materials\": {\"a\": 1}}",
                   "s:2:20: a material must be an object, { ... }, not a number"},
        SceneFault{
            "\"bodies\": [{\"orientation\": [1, 0, 0]}]}",
            "s:2:28: \"orientation\" must be a list of four numbers, the quaternion [w, x, y, z], not of 3 "
            "values"},
        // names
        SceneFault{"\"solver\": \"soft_stop\"}",
                   "s:2:11: unknown solver \"soft_stop\"; did you mean \"soft_step\"? (impulse, soft_step or "
                   "jacobi_split)"},
        SceneFault{"\"integrator\": \"rk5\"}", "s:2:15: unknown integrator \"rk5\"; did you mean \"rk4\"?"},
        SceneFault{"\"rotation_update\": \"lie\"}",
                   "s:2:20: unknown rotation_update \"lie\"; expected first_order or lie_group"},
        SceneFault{"\"precision\": \"f16\"}", "s:2:14: unknown precision \"f16\"; expected f32 or f64"},
        SceneFault{"\"effects\": \"all\"}", "s:2:12: \"effects\" must be \"auto\" or a list of effects"},
        SceneFault{"\"effects\": [\"gravity\", \"magic\"]}",
                   "s:2:24: unknown effect \"magic\"; expected gravity, attractor, "},
        SceneFault{"\"effects\": [\"friction\", \"rotation\"], \"solver\": \"impulse\"}",
                   "s:2:12: effects: must not contain friction with the solver impulse"},
        SceneFault{"\"solver\": \"soft_step\", \"effects\": [\"friction\"]}",
                   "s:2:35: effects: must contain rotation if they contain friction"},
        SceneFault{"\"effects\": [\"gravity\", 3]}", "s:2:24: unknown effect \"3\""},
        SceneFault{"\"effects\": [\"gravity\", \"gravity\"]}",
                   "s:2:24: \"gravity\" appears twice in this list"},
        SceneFault{"\"bodies\": [{\"material\": \"steel\"}]}",
                   "s:2:25: unknown material \"steel\"; expected \"default\""},
        SceneFault{"\"bodies\": [{\"shape\": \"cube\"}]}",
                   "s:2:22: unknown shape \"cube\"; expected sphere or mesh"},
        SceneFault{"\"bodies\": [{\"motion\": \"fixed\"}]}",
                   "s:2:23: unknown motion \"fixed\"; expected dynamic, kinematic or static"},
        SceneFault{"\"bodies\": [{\"motion\": \"static\", \"velocity\": [0, 0, 1]}]}",
                   "s:2:23: bodies[0].motion: must be kinematic or dynamic if a velocity is given"},
        SceneFault{"\"restitution_threshold\": \"none\"}",
                   "s:2:26: \"restitution_threshold\" must be \"auto\" or a number"},
        // ranges, found by validate()
        SceneFault{"\"bodies\": [{}, {\"radius\": -1}]}",
                   "s:2:27: bodies[1].radius: must lie in [1e-09, 1e+09] m, not -1"},
        SceneFault{"\"bodies\": [{\"radius\": 0}]}",
                   "s:2:23: bodies[0].radius: must lie in [1e-09, 1e+09] m, not 0"},
        SceneFault{"\"bodies\": [{\"position\": [0, 2e9, 0]}]}",
                   "s:2:29: bodies[0].position[1]: must lie in"},
        SceneFault{"\"bodies\": [{\"orientation\": [0, 0, 0, 0]}]}",
                   "s:2:28: the quaternion [w, x, y, z] must not be zero"},
        SceneFault{"\"obstacles\": [{\"shape\": \"plane\", \"normal\": [0, 0, 0]}]}",
                   "s:2:44: the normal must not be zero"},
        SceneFault{"\"materials\": {\"a b\": {\"density\": 0}}}",
                   "s:2:34: materials[\"a b\"].density: must lie in [1e-09, 1e+18] kg/m^3, not 0"},
        SceneFault{"\"materials\": {\"a\\\"b\": {}}}",
                   "s:2:23: materials[\"a\"b\"]: a material's name must be"},
        SceneFault{"\"materials\": {\"a\\nb\": {}}}",
                   "s:2:23: materials[\"a?b\"]: a material's name must be"},
        SceneFault{"\"bodies\": [{\"shape\": \"mesh\", \"mesh\": \"a\\nb.obj\"}]}",
                   "s:2:38: bodies[0].mesh: must be a path in UTF-8 without control characters, not \"a"},
        SceneFault{"\"substeps\": 1e30}",
                   "s:2:13: substeps: must be a whole number from 1 to 1000, not 1e30"},
        SceneFault{"\"steps_per_second\": 0}",
                   "s:2:21: steps_per_second: must be a whole number from 1 to 1000000, not 0"},
        SceneFault{"\"box\": {\"max\": [0, 1, 1]}}",
                   "s:2:17: box.max[0]: must be more than min[0] = 0, not 0"},
        SceneFault{"\"box\": {\"min\": [100, 0, 0]}}", "s:2:8: box.max[0]: must be more than min[0] = 100"},
        SceneFault{"\"drag\": {\"density\": -1}}",
                   "s:2:21: drag.density: must lie in [0, 1e+09] kg/m^3, not -1"},
        SceneFault{"\"drag\": {\"viscous\": 1}}",
                   "s:2:10: unknown key \"viscous\" in drag; expected viscosity, density or coefficient"},
        SceneFault{"\"attractors\": [{\"strength\": 1}], \"solver\": \"impulse\"}",
                   "s:2:15: attractors: must not contain attractors with the solver impulse"},
        SceneFault{"\"effects\": [\"attractor\"], \"solver\": \"impulse\"}",
                   "s:2:12: effects: must not contain attractors with the solver impulse"},
        // effects that impulse lacks
        SceneFault{"\"materials\": {\"default\": {\"friction\": 0.5}}, \"solver\": \"impulse\"}",
                   "s:2:39: materials.default.friction: must be 0 with the solver impulse"},
        SceneFault{"\"solver\": \"soft_step\", \"materials\": {\"default\": {\"friction\": 101}}}",
                   "s:2:62: materials.default.friction: must lie in [0, 100], not 101"},
        SceneFault{"\"materials\": {\"default\": {\"rolling_resistance\": 0.1}}, \"solver\": \"impulse\"}",
                   "s:2:49: materials.default.rolling_resistance: must be 0 with the solver impulse"},
        SceneFault{"\"solver\": \"soft_step\", \"effects\": [\"rotation\", \"rolling_resistance\"]}",
                   "s:2:35: effects: must contain friction if they contain rolling_resistance"},
        SceneFault{"\"obstacles\": [{\"shape\": \"box\"}], \"solver\": \"impulse\"}",
                   "s:2:25: obstacles[0].shape: must be plane with the solver impulse"},
        SceneFault{"\"solver\": \"soft_step\", \"obstacles\": [{\"shape\": \"plane\"}, {\"shape\": \"box\", "
                   "\"size\": [1, 0, 1]}]}",
                   "s:2:87: obstacles[1].size[1]: must lie in [1e-09, 1e+09] m, not 0"},
        SceneFault{"\"obstacles\": [{}]}",
                   "s:2:15: an obstacle must have \"shape\": \"plane\" or \"shape\": \"box\""},
        SceneFault{
            "\"gravity\": [0, 0, 0], \"box\": {}, \"generators\": [{\"kind\": \"box_collider\", \"variant\": "
            "\"settled\"}]}",
            "s:2:85: generators[0].variant: must not be settled without gravity"},
        SceneFault{"\"solver\": \"impulse\", \"sleep\": {}}",
                   "s:2:31: sleep: must be removed with the solver impulse"},
        SceneFault{"\"solver\": \"soft_step\", \"sleep\": true}",
                   "s:2:33: \"sleep\" must be an object, { ... }, not true or false"},
        SceneFault{"\"solver\": \"soft_step\", \"sleep\": {\"sped\": 1}}", "s:2:34: unknown key \"sped\""},
        SceneFault{"\"solver\": \"soft_step\", \"sleep\": {\"speed\": -1}}",
                   "s:2:43: sleep.speed: must lie in [0, 1e+09] m/s, not -1"},
        SceneFault{"\"solver\": \"soft_step\", \"sleep\": {\"time\": 2e6}}",
                   "s:2:42: sleep.time: must lie in [0, 1e+06] s, not 2e6"},
        SceneFault{"\"guards\": {\"on_failure\": \"stop\"}}",
                   "s:2:26: unknown on_failure \"stop\"; expected pause or freeze"},
        SceneFault{"\"guards\": {\"speed\": -1}}",
                   "s:2:21: guards.speed: must lie in [0, 1e+18] m/s, not -1"},
        SceneFault{"\"guards\": {\"spin\": 1e19}}",
                   "s:2:20: guards.angular_speed: must lie in [0, 1e+18] rad/s, not 1e19"},
        SceneFault{"\"guards\": {\"distance\": \"far\"}}", "s:2:24: \"distance\" must be a number"},
        SceneFault{"\"effects\": [\"sleeping\"]}",
                   "s:2:12: effects: must not contain sleeping without \"sleep\""},
        // generators
        SceneFault{"\"generators\": [{\"kind\": \"box_collider\"}]}",
                   "s:2:16: generators[0]: needs a \"box\""},
        SceneFault{
            "\"box\": {}, \"generators\": [{\"kind\": \"box_collider\", \"count\": 3, \"without\": [0, 3]}]}",
            "s:2:79: generators[0].excluded[1]: must be the index of one of its 3 bodies, from 0, in "
            "ascending order"},
        SceneFault{"\"box\": {}, \"generators\": [{\"kind\": \"box_collider\", \"without\": [1.5]}]}",
                   "s:2:64: \"excluded\" must be a list of whole numbers"},
        SceneFault{"\"added\": [{\"radius\": 0}]}", "s:2:22: extra_bodies[0].radius: must lie in"},
        SceneFault{"\"box\": {}, \"generators\": [{}]}",
                   "s:2:27: a generator must have \"kind\": \"box_collider\""},
        SceneFault{"\"box\": {}, \"generators\": [{\"kind\": \"rain\"}]}",
                   "s:2:36: a generator must have \"kind\""},
        SceneFault{
            "\"box\": {}, \"generators\": [{\"kind\": \"box_collider\", \"count\": 10000000000}]}",
            "s:2:61: generators[0].count: must be a whole number from 0 to 134217728, not 10000000000"},
        SceneFault{"\"box\": {}, \"generators\": [{\"kind\": \"box_collider\", \"count\": 1e300}]}",
                   "s:2:61: generators[0].count: must be a whole number from 0 to 134217728, not 1e300"},
        SceneFault{"\"box\": {}, \"generators\": [{\"kind\": \"box_collider\", \"seed\": -1}]}",
                   "s:2:60: \"seed\" must be a whole number from 0 to 18446744073709551615, not -1"},
        SceneFault{
            "\"box\": {}, \"generators\": [{\"kind\": \"box_collider\", \"seed\": 18446744073709551616}]}",
            "s:2:60: \"seed\" must be a whole number from 0 to"},
        SceneFault{"\"box\": {}, \"generators\": [{\"kind\": \"box_collider\", \"seed\": 1e30}]}",
                   "s:2:60: \"seed\" must be a whole number from 0 to 18446744073709551615, not 1e30"},
        SceneFault{"\"box\": {}, \"generators\": [{\"kind\": \"box_collider\", \"seed\": 0.5}]}",
                   "s:2:60: \"seed\" must be a whole"},
        SceneFault{
            "\"box\": {}, \"generators\": [{\"kind\": \"box_collider\", \"radius_max\": 60}]}",
            "s:2:66: generators[0].radius_max: must be at most 50 m, for the spheres to fit in the box, not "
            "60"},
        // exclusive alternatives
        SceneFault{"\"time_step\": 0.1, \"steps_per_second\": 10}",
                   "s:2:19: time_step and steps_per_second are both given; keep one of them"},
        SceneFault{"\"bodies\": [{\"shape\": \"mesh\", \"mesh\": \"a.obj\", \"radius\": 1}]}",
                   "s:2:47: a mesh has no radius"},
        SceneFault{"\"bodies\": [{\"mesh\": \"a.obj\"}]}", "s:2:13: a sphere has no mesh"},
        SceneFault{"\"bodies\": [{\"shape\": \"mesh\"}]}", "s:2:12: bodies[0].mesh: must name an OBJ file"},
        // camera
        SceneFault{"\"camera\": {\"vertical_field_of_view\": 0}}",
                   "s:2:38: camera.vertical_field_of_view: must lie in [1, 150] degrees, not 0"},
        // syntax
        SceneFault{"\"name\": 1e999}", "s:2:9: 1e999 is out of range of a double"},
        SceneFault{"\"gravity\": [0, 0, NaN]}", "s:2:19: NaN is not a finite number"},
        SceneFault{"\"gravity\": [0, 0",
                   "s:2:17: unexpected end of the document inside the array opened on line 2"}));

TEST(SceneFile, HeadersAreRequired) {
  EXPECT_THAT(faults_of("{}"),
              ElementsAre("s:1:1: a scene must start with \"format\": \"collidoscope-scene\"",
                          "s:1:1: \"version\" is missing; expected 1"));
  EXPECT_THAT(faults_of("{\"format\": \"x\", \"version\": 2}"),
              ElementsAre("s:1:12: a scene must start with \"format\": \"collidoscope-scene\"",
                          "s:1:28: unknown version of the format; expected 1"));
  EXPECT_THAT(faults_of("[]"), ElementsAre("s:1:1: a scene must be an object, { ... }, not a list"));
}

TEST(SceneFile, EveryFaultIsListedInTheOrderOfTheText) {
  EXPECT_THAT(
      faults_of(head +
                "\"colour\": 1,\n\"bodies\": [{\"radius\": -1, \"mass\": \"heavy\"},\n{\"velocity\": 3}],\n"
                "\"substeps\": 0, \"substeps\": 1}"),
      ElementsAre(StartsWith("s:2:1: unknown key \"colour\""), StartsWith("s:3:23: bodies[0].radius"),
                  StartsWith("s:3:35: \"mass\" must be a number, not a string"),
                  StartsWith("s:4:14: \"velocity\""), StartsWith("s:5:13: substeps: must be"),
                  StartsWith("s:5:16: duplicate key \"substeps\"")));
}

TEST(SceneFile, HundredsOfThousandsOfFaultsTakeNoTime) {
  std::string text = head + "\"bodies\": [{}";
  for (int i = 0; i < 200'000; ++i) text += ",\n{\"radius\": -1}";
  EXPECT_EQ(faults_of(text + "]}").size(), 10'001u);
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

/// Random scenes for the round trip: every field, with awkward values.
class RandomScene {
 public:
  explicit RandomScene(unsigned seed) : random_(seed) {}

  Scene make() {
    Scene s;
    s.name =
        pick<std::string>({"", "plain", "quote \" and \\ and /", "\xC3\xA9\xE2\x82\xAC\xF0\x9F\x98\x80"});
    if (coin()) {
      s.box = Box{};
      s.box->min = vector(50);
      s.box->max = s.box->min + Vector3d(real(1, 1e3), real(1, 1e3), real(1, 1e3));
    }
    Physics& p = s.physics;
    p.gravity = coin() ? vector(20) : Vector3d(0, -0.0, 0);
    p.time_step = real(1e-4, 0.1);
    if (coin()) {
      p.time_step = TimeStep::per_second(1 + static_cast<int>(random_() % 1000));
    }
    p.solver = pick({Solver::impulse, Solver::soft_step});
    if (coin()) p.drag = {real(0, 1), real(0, 1000), real(0, 2)};
    if (p.solver == Solver::soft_step && coin()) p.attractors = {{vector(100), real(-9, 9), real(1, 2)}, {}};
    if (coin()) p.substeps = 1 + static_cast<int>(random_() % 1000);
    p.iterations = 1 + static_cast<int>(random_() % 1000);
    p.integrator = pick({Integrator::semi_implicit_euler, Integrator::velocity_verlet, Integrator::rk4});
    p.rotation_update = pick({RotationUpdate::first_order, RotationUpdate::lie_group});
    p.precision = pick({Precision::f32, Precision::f64});
    if (coin()) p.effects = Effects{.gravity = coin(), .rotation = coin()};
    if (coin()) p.restitution_threshold = real(0, 2);
    if (coin() && p.solver == Solver::soft_step) p.sleep = Sleep{real(0, 1), real(0, 10)};
    s.materials[0].density = real(1, 1e4);
    for (const char* name : {"steel", "a b", "x.y[3]", "\xC3\xA9"}) {
      if (coin())
        s.materials.push_back({.name = name, .density = real(1e-3, 1e5), .restitution = real(0, 1)});
    }
    for (int i = static_cast<int>(random_() % 4); i > 0; --i) s.bodies.push_back(body(s));
    for (int i = static_cast<int>(random_() % 3); s.box && i > 0; --i) {
      s.generators.push_back(
          {.count = static_cast<std::int64_t>(random_() % 100000),
           .radius_max = real(0.001, 0.5),
           .variant = i == 1 ? pick({Variant::paper, Variant::scaled, Variant::equal}) : Variant::paper,
           .spawn = pick({Spawn::inside, Spawn::centres, Spawn::apart}),
           .seed = random_(),
           .speed_max = real(0, 10),
           .material = material(s)});
    }
    for (int i = static_cast<int>(random_() % 3); i > 0; --i) {
      s.obstacles.push_back(
          {.normal = vector(1).normalized(), .offset = real(-10, 10), .material = material(s)});
    }
    for (int i = static_cast<int>(random_() % 4); s.bodies.size() > 1 && i > 0; --i)
      s.joints.push_back(joint());
    if (s.physics.solver == Solver::impulse) s.physics.effects = Effects{};
    if (s.physics.solver == Solver::soft_step && coin())
      s.boxes.push_back({vector(10), Vector3d(real(1, 2), real(1, 2), real(1, 2)),
                         Quaterniond(real(-1, 1), real(-1, 1), real(-1, 1), real(-1, 1)).normalized(),
                         material(s)});
    if (coin()) s.camera.position = vector(1000);
    if (coin()) s.camera.target = vector(1000);
    s.camera.up = vector(1);
    s.camera.vertical_field_of_view = real(1, 150);
    return s;
  }

 private:
  Body body(const Scene& s) {
    Body b;
    b.radius = real(1e-3, 0.5);
    if (coin()) {
      b = Body{};
      b.shape = Shape::mesh;
      b.mesh = pick<std::string>({"a.obj", "dir/b c.obj", "C:\\x.obj", "\xC3\xA9.obj"});
    }
    b.position = vector(1e6);
    b.motion = pick({Motion::dynamic, Motion::kinematic});
    if (coin()) b.orientation = Quaterniond(real(-1, 1), real(-1, 1), real(-1, 1), real(-1, 1)).normalized();
    if (coin()) b.velocity = coin() ? vector(100) : Vector3d(-0.0, 0, 0);
    if (coin()) b.angular_velocity = vector(100);
    if (coin()) b.mass = real(1e-20, 1e20);
    if (coin()) b.inertia = Vector3d(real(1, 2), real(1, 2), real(1, 2));
    b.material = material(s);
    return b;
  }
  Joint joint() {
    Joint j;
    j.kind = pick({JointKind::distance, JointKind::spring, JointKind::ball, JointKind::hinge});
    j.a = coin() ? 0 : 1;
    if (coin()) j.b = 1 - j.a;
    j.anchor_a = coin() ? vector(10) : Vector3d(0, -0.0, 0);
    if (!j.b || coin()) j.anchor_b = vector(10);
    const bool spring = j.kind == JointKind::spring;
    if ((spring || j.kind == JointKind::distance) && coin())
      j.length = real(0.1, 9);
    else if (j.kind == JointKind::distance && coin())
      j.min_length = real(0, 1), j.max_length = real(1, 2);
    if (spring) j.frequency = real(1, 9), j.damping_ratio = real(0, 2);
    if (j.kind == JointKind::hinge) j.axis = vector(1).normalized();
    if (j.kind == JointKind::hinge && coin()) j.limits = {real(-180, 0), real(0, 180)};
    j.collide = coin();
    return j;
  }
  bool coin() { return random_() % 2 == 0; }
  int material(const Scene& s) { return static_cast<int>(random_() % s.materials.size()); }
  double real(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Vector3d vector(double most) { return {real(-most, most), real(-most, most), real(-most, most)}; }
  template <class Value>
  Value pick(std::initializer_list<Value> values) {
    return values.begin()[random_() % values.size()];
  }
  std::mt19937_64 random_;
};

/// All bits of a scene's fields, one line per value, independent of write_scene().
std::string bits(const Scene& s) {
  std::string text;
  const auto real = [&](double x) { text += std::to_string(std::bit_cast<std::uint64_t>(x)) + " "; };
  const auto vec = [&](const Vector3d& v) {
    for (int i = 0; i < 3; ++i) real(v[i]);
  };
  const auto whole = [&](auto x) { text += std::to_string(x) + " "; };
  text += s.name + "\n";
  whole(s.box.has_value());
  if (s.box) vec(s.box->min), vec(s.box->max);
  const Physics& p = s.physics;
  real(p.drag.viscosity), real(p.drag.density), real(p.drag.coefficient);
  for (const Attractor& a : p.attractors) vec(a.position), real(a.strength), real(a.softening);
  vec(p.gravity), real(p.time_step), whole(p.time_step.steps_per_second().value_or(-1)),
      whole(p.substeps.value_or(-1)), whole(p.iterations);
  whole(static_cast<int>(p.solver)), whole(static_cast<int>(p.integrator)),
      whole(static_cast<int>(p.rotation_update)), whole(static_cast<int>(p.precision));
  whole(p.effects ? p.effects->gravity + 2 * p.effects->rotation : -1),
      real(p.restitution_threshold.value_or(-1));
  whole(p.sleep.has_value()), real(p.sleep.value_or(Sleep{}).speed), real(p.sleep.value_or(Sleep{}).time);
  for (const Material& m : s.materials) {
    text += "\n" + m.name + " ";
    real(m.density), real(m.restitution), real(m.friction), real(m.rolling_resistance);
  }
  for (const Body& b : s.bodies) {
    text += "\n" + b.mesh + " ";
    whole(static_cast<int>(b.motion));
    whole(static_cast<int>(b.shape)), real(b.radius), vec(b.position), vec(b.velocity),
        vec(b.angular_velocity);
    real(b.orientation.w()), real(b.orientation.x()), real(b.orientation.y()), real(b.orientation.z());
    real(b.mass.value_or(-1)), vec(b.inertia.value_or(Vector3d(-1, -1, -1))), whole(b.material);
  }
  for (const BoxCollider& g : s.generators) {
    text += "\n";
    whole(g.count), real(g.radius_max), whole(static_cast<int>(g.variant)), whole(static_cast<int>(g.spawn));
    whole(g.seed), real(g.speed_max), whole(g.material);
  }
  for (const Plane& o : s.obstacles) text += "\n", vec(o.normal), real(o.offset), whole(o.material);
  for (const BoxObstacle& o : s.boxes) {
    text += "\n", vec(o.center), vec(o.size), whole(o.material);
    real(o.orientation.w()), real(o.orientation.x()), real(o.orientation.y()), real(o.orientation.z());
  }
  const Vector3d unset(-1, -1, -1);
  for (const Joint& j : s.joints) {
    text += "\n";
    whole(static_cast<int>(j.kind)), whole(j.a), whole(j.b.value_or(-1)), whole(j.collide);
    vec(j.anchor_a), vec(j.anchor_b.value_or(unset)), vec(j.axis), real(j.frequency), real(j.damping_ratio);
    for (const std::optional<double>& length : {j.length, j.min_length, j.max_length})
      real(length.value_or(-1));
    if (j.limits) real((*j.limits)[0]), real((*j.limits)[1]);
  }
  text += "\n";
  vec(s.camera.position.value_or(unset)), vec(s.camera.target.value_or(unset)), vec(s.camera.up);
  real(s.camera.vertical_field_of_view);
  return text;
}

TEST(SceneFile, FaultsOfJointsHaveTheirPlace) {
  const std::string jointed = head + R"("solver": "soft_step", "bodies": [{}, {}, {}], "joints": [
)";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {R"({"a": 0, "b": 1})", R"(s:3:1: a joint must have a "kind": distance, spring, ball or hinge)"},
      {R"({"kind": "rope", "a": 0, "b": 1})", R"(s:3:10: unknown kind "rope"; expected distance, spring)"},
      {R"({"kind": "ball", "b": 1})", R"(s:3:1: a joint's "a" must be the id of a body)"},
      {R"({"kind": "ball", "a": 0})", R"(s:3:1: a joint's "b" must be the id of a body or "world")"},
      {R"({"kind": "ball", "a": 0, "b": "wall"})",
       R"(s:3:31: a joint's "b" must be the id of a body or "world")"},
      {R"({"kind": "ball", "a": 0, "b": 0.5})", R"(s:3:31: "b" must be a whole number, not 0.5)"},
      {R"({"kind": "ball", "a": 3, "b": 1})",
       "s:3:23: joints[0].a: must be the id of a body, below 3, not 3"},
      {R"({"kind": "ball", "a": 0, "b": 1, "length": 1})",
       R"(s:3:34: "length" is valid only for distances and springs)"},
      {R"({"kind": "ball", "a": 0, "b": 1, "axis": [0, 0, 1]})",
       R"(s:3:34: "axis" is valid only for hinges)"},
      {R"({"kind": "hinge", "a": 0, "b": 1, "axis": [0, 0, 0]})", "s:3:43: the axis must not be zero"},
      {R"({"kind": "hinge", "a": 0, "b": 1, "limits": 5})",
       R"(s:3:45: "limits" must be a list of two angles)"},
      {R"({"kind": "ball", "a": 0, "b": 1, "collide": 1})",
       R"(s:3:45: "collide" must be true or false, not a number)"},
      {R"({"kind": "ball", "a": 0, "b": 1, "colide": true})",
       R"(s:3:34: unknown key "colide" in a joint; did)"},
      {R"({"kind": "distance", "a": 0, "b": "world"})",
       "s:3:1: joints[0].anchor_b: must be given for a joint to the world"},
  };
  for (const auto& [joint, fault] : cases)
    EXPECT_THAT(faults_of(jointed + joint + "]}"), testing::ElementsAre(testing::StartsWith(fault))) << joint;
}

TEST(SceneFile, WritingAndReadingKeepsEveryBit) {
  for (unsigned seed = 0; seed < 2000; ++seed) {
    const Scene scene = RandomScene(seed).make();
    const std::vector<Fault> faults = validate(scene);
    ASSERT_TRUE(faults.empty()) << seed << " " << faults[0].path << " " << faults[0].message;
    const std::string text = write_scene(scene);
    const Scene again = parse_scene(text, "s");
    ASSERT_EQ(bits(again), bits(scene)) << seed << "\n" << text;
    ASSERT_EQ(write_scene(again), text);
  }
}

TEST(SceneFile, WhoCameAndWhoLeftSurvivesTheRoundTrip) {
  Scene scene;
  scene.box = Box{};
  scene.generators.resize(1);
  scene.generators[0].excluded = {1, 5, 1999};
  scene.extra_bodies.resize(2);
  scene.extra_bodies[1].position = Vector3d(0.1, 0.2, 0.3);
  const Scene again = parse_scene(write_scene(scene), "text");
  EXPECT_EQ(again.generators.at(0).excluded, scene.generators[0].excluded);
  ASSERT_EQ(again.extra_bodies.size(), 2u);
  EXPECT_EQ(again.extra_bodies[1].position, scene.extra_bodies[1].position);
  EXPECT_EQ(write_scene(again), write_scene(scene));
}

TEST(SceneFile, ScenesOfTheProjectSurviveTheRoundTrip) {
  for (const auto& entry : std::filesystem::directory_iterator(project_file("assets/scenes"))) {
    if (entry.path().extension() != ".json") continue;
    const Scene scene = read_scene(entry.path().string());
    EXPECT_EQ(bits(parse_scene(write_scene(scene), "s")), bits(scene)) << entry.path();
  }
}

// A damaged file gives complete fault lines or a valid scene, whatever byte is changed.
TEST(SceneFile, SpoiltFilesAreNeverWorseThanFaults) {
  const std::string good = write_scene(RandomScene(5).make());
  std::mt19937 random(1);
  for (int i = 0; i < 3000; ++i) {
    std::string spoilt = good;
    for (int k = 0; k < 3; ++k) {
      const std::size_t at = random() % spoilt.size();
      switch (random() % 3) {
        case 0:
          spoilt[at] = static_cast<char>(random());
          break;
        case 1:
          spoilt.erase(at, random() % 8);
          break;
        default:
          spoilt.insert(at, spoilt.substr(random() % spoilt.size(), random() % 8));
          break;
      }
    }
    for (const std::string& line : faults_of(spoilt))
      EXPECT_THAT(line, testing::MatchesRegex("s:[0-9]+:[0-9]+: .+"));
  }
}

// Keys that were renamed are still read, each with a warning; what is written has the new keys.
TEST(SceneFile, OldKeysAreReadWithAWarning) {
  const std::string head = R"({"format": "collidoscope-scene", "version": 1, "box": {},
)";
  const Scene old = parse_scene(head + R"("guards": {"spin": 7}, "added": [{"radius": 2}],
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
  EXPECT_THAT(faults_of(head + R"("guards": {"spin": -1}})"),
              testing::ElementsAre(testing::StartsWith("s:2:20: guards.angular_speed: must lie in")));
  EXPECT_THAT(faults_of(head + R"("spin": 1})"),
              testing::ElementsAre(testing::HasSubstr("unknown key \"spin\"")));
}

}  // namespace
}  // namespace collidoscope

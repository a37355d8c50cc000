// Tests faults of scene files: one case for each field and rule, with the position in the text.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/scene_text.h"

namespace collidoscope {
namespace {

using testing::ElementsAre;
using testing::StartsWith;

struct SceneFault {
  std::string text;  ///< the text after `scene_head`, which begins on line 2
  std::string line;
};
class BadScene : public testing::TestWithParam<SceneFault> {};
TEST_P(BadScene, IsOneLineWithItsPosition) {
  EXPECT_THAT(scene_faults_of(scene_head + GetParam().text), ElementsAre(StartsWith(GetParam().line)));
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

TEST(SceneFileFaults, HeadersAreRequired) {
  EXPECT_THAT(scene_faults_of("{}"),
              ElementsAre("s:1:1: a scene must start with \"format\": \"collidoscope-scene\"",
                          "s:1:1: \"version\" is missing; expected 1"));
  EXPECT_THAT(scene_faults_of("{\"format\": \"x\", \"version\": 2}"),
              ElementsAre("s:1:12: a scene must start with \"format\": \"collidoscope-scene\"",
                          "s:1:28: unknown version of the format; expected 1"));
  EXPECT_THAT(scene_faults_of("[]"), ElementsAre("s:1:1: a scene must be an object, { ... }, not a list"));
}

TEST(SceneFileFaults, EveryFaultIsListedInTheOrderOfTheText) {
  EXPECT_THAT(scene_faults_of(
                  scene_head +
                  "\"colour\": 1,\n\"bodies\": [{\"radius\": -1, \"mass\": \"heavy\"},\n{\"velocity\": 3}],\n"
                  "\"substeps\": 0, \"substeps\": 1}"),
              ElementsAre(StartsWith("s:2:1: unknown key \"colour\""), StartsWith("s:3:23: bodies[0].radius"),
                          StartsWith("s:3:35: \"mass\" must be a number, not a string"),
                          StartsWith("s:4:14: \"velocity\""), StartsWith("s:5:13: substeps: must be"),
                          StartsWith("s:5:16: duplicate key \"substeps\"")));
}

TEST(SceneFileFaults, HundredsOfThousandsOfFaultsTakeNoTime) {
  std::string text = scene_head + "\"bodies\": [{}";
  for (int i = 0; i < 200'000; ++i) text += ",\n{\"radius\": -1}";
  EXPECT_EQ(scene_faults_of(text + "]}").size(), 10'001u);
}

TEST(SceneFileFaults, FaultsOfJointsHaveTheirPlace) {
  const std::string jointed = scene_head + R"("solver": "soft_step", "bodies": [{}, {}, {}], "joints": [
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
    EXPECT_THAT(scene_faults_of(jointed + joint + "]}"), testing::ElementsAre(testing::StartsWith(fault)))
        << joint;
}
}  // namespace
}  // namespace collidoscope

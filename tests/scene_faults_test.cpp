// Tests that all faults of a scene file are listed together, each with its line and column. The real program
// prints them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "tests/run_program.h"

namespace collidoscope {
namespace {

using testing::ElementsAre;
using testing::MatchesRegex;
using testing::StartsWith;

/// The lines that the program prints for a scene with this text, without the file name.
std::vector<std::string> lines_of(const std::string& text, const std::vector<std::string>& flags = {}) {
  const TemporaryFolder folder;
  const std::string file = folder / "s.json";
  std::ofstream(file) << text;
  std::vector<std::string> arguments{"run", file, "--steps", "0"};
  arguments.insert(arguments.end(), flags.begin(), flags.end());
  const Outcome outcome = run_headless(arguments);
  EXPECT_EQ(outcome.status, 2) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  std::vector<std::string> lines;
  std::istringstream stream(outcome.err);
  for (std::string line; std::getline(stream, line);)
    lines.push_back(line.starts_with(file + ":") ? line.substr(file.size() + 1) : line);
  return lines;
}

const std::string begin = "{\"format\": \"collidoscope-scene\", \"version\": 1,\n";

TEST(SceneFaults, AreListedBesideWordsThatAreNoNumbers) {
  EXPECT_THAT(
      lines_of(begin + R"( "time_step": NaN,
 "gravity": [0, 1e999, 0], "solvr": Infinity,
 "bodies": [
  {"radius": -1, "mass": 01, "velocity": [-inf, 0, 1e10]},
  {"radius": None, "radios": 2},
  {"position": [5, 0, true]}
 ]})"),
      ElementsAre("2:15: NaN is not a finite number; write a finite number",
                  "3:17: 1e999 is out of range of a double; the maximum is 1.8e308",
                  "3:28: unknown key \"solvr\" in a scene; did you mean \"solver\"?",
                  "3:37: Infinity is not a finite number; write a finite number",
                  "5:14: bodies[0].radius: must lie in [1e-09, 1e+09] m, not -1",
                  StartsWith("5:26: \"01\" is not a JSON number"),
                  "5:43: -inf is not a finite number; write a finite number",
                  StartsWith("6:14: None is not a JSON value"),
                  "6:20: unknown key \"radios\" in a body; did you mean \"radius\"?",
                  "7:23: \"position\" must be a list of three numbers, [x, y, z]; this is true or false"));
}

TEST(SceneFaults, AreListedOfEachValueThatAKeyHas) {
  EXPECT_THAT(lines_of(begin + R"( "gravity": [0, 0, -9.81],
 "gravity": [0, 0, "x"],
 "bodies": [{"radius": 1, "radius": -2}],
 "bodies": [{"radius": -3, "mas": 1}],
 "bodies": [{"radius": -4}]})"),
              ElementsAre("3:2: duplicate key \"gravity\" in this object; keep one of them",
                          "3:20: \"gravity\" must be a list of three numbers, [x, y, z]; this is a string",
                          "4:27: duplicate key \"radius\" in this object; keep one of them",
                          "4:37: bodies[0].radius: must lie in [1e-09, 1e+09] m, not -2",
                          "5:2: duplicate key \"bodies\" in this object; keep one of them",
                          "5:24: bodies[0].radius: must lie in [1e-09, 1e+09] m, not -3",
                          "5:28: unknown key \"mas\" in a body; did you mean \"mass\"?",
                          "6:2: duplicate key \"bodies\" in this object; keep one of them",
                          "6:24: bodies[0].radius: must lie in [1e-09, 1e+09] m, not -4"));
}

TEST(SceneFaults, BeforeTheTextBreaksOffAreListed) {
  EXPECT_THAT(
      lines_of(begin + " \"time_step\": nan,\n \"bodies\": [{\"radius\": 1e999}\n"),
      ElementsAre(StartsWith("2:15: nan is not a finite number"), StartsWith("3:24: 1e999 is out of range"),
                  StartsWith("4:1: unexpected end of the document inside the array")));
  // Words inside strings and comments are ignored.
  EXPECT_THAT(lines_of(begin + " // NaN\n \"name\": \"NaN \\\" 1e999\", /* inf */ \"iterations\": +3}"),
              ElementsAre(StartsWith("3:50: \"+3\" is not a JSON number")));
}

TEST(SceneFaults, AreTwentyAtMost) {
  std::string text = begin + "\"bodies\": [";
  for (int k = 0; k < 27; ++k)
    text += std::string(k > 0 ? "," : "") + "\n{\"radius\": " + (k % 2 == 0 ? "NaN" : "-1") + "}";
  const std::vector<std::string> lines = lines_of(text + "]}");
  ASSERT_EQ(lines.size(), 21u);
  EXPECT_THAT(lines[0], StartsWith("3:12: NaN"));
  EXPECT_THAT(lines[19], StartsWith("22:12: bodies[19].radius: must lie in"));
  EXPECT_EQ(lines[20], "and 7 more errors");
}

TEST(SceneFaults, OfDerivedMassesHaveALine) {
  const std::string range = " kg (density times volume); it must be in [1e-30, 1e+30] kg";
  EXPECT_THAT(lines_of(begin + R"( "materials": {"default": {"density": 1e-9}, "heavy": {"density": 1e18}},
 "bodies": [
  {"radius": 1},
  {"radius": 1e-8, "position": [5, 0, 0]},
  {"radius": 1e8, "position": [3e8, 0, 0], "material": "heavy"},
  {"radius": -1}
 ]})"),
              ElementsAre("5:3: bodies[1]: its mass would be 4.19e-33" + range,
                          "6:3: bodies[2]: its mass would be 4.19e+42" + range,
                          "7:14: bodies[3].radius: must lie in [1e-09, 1e+09] m, not -1"));
  // These faults only show in the generated bodies, or for bodies that rotate.
  EXPECT_THAT(lines_of(begin + R"( "box": {"min": [0, 0, 0], "max": [1e9, 1e9, 1e9]},
 "materials": {"default": {"density": 1e18}},
 "generators": [{"kind": "box_collider", "count": 3,
  "radius_max": 1e6}]})",
                       {"--guards", "off"}),
              ElementsAre("4:17: generators[0]: its largest sphere's mass would be 4.19e+36" + range));
  EXPECT_THAT(lines_of(begin + R"( "bodies": [
  {"radius": 1},
  {"radius": 1e-8, "position": [5, 0, 0], "angular_velocity": [1, 0, 0]}]})"),
              ElementsAre(StartsWith("4:3: bodies[1]: its moment of inertia would be 1.68e-37 kg m^2")));
}

// In commit 8efde11 an invalid number hid faults derived from other values, and a missing mesh file had no
// line.
TEST(SceneFaults, OfDerivedValuesAreListedBesideOthers) {
  EXPECT_THAT(lines_of(begin + R"( "time_step": NaN,
 "box": {"min": [0, 0, 0], "max": [1e9, 1e9, 1e9]},
 "materials": {"default": {}, "heavy": {"density": 1e18}},
 "bodies": [
  {"radius": 1e-8, "angular_velocity": [1, 0, 0]},
  {"shape": "mesh", "mesh": "none.obj", "position": [5, 0, 0]},
  {"shape": "mesh", "mesh": "s.json", "position": [9, 0, 0]}],
 "generators": [{"kind": "box_collider", "count": 3, "radius_max": 1e6, "material": "heavy"}]})"),
              ElementsAre(StartsWith("2:15: NaN is not a finite number"),
                          StartsWith("6:3: bodies[0]: its moment of inertia would be 1.68e-37 kg m^2"),
                          MatchesRegex("7:29: bodies.1..mesh: .*none.obj: cannot be opened .No such file.*"),
                          MatchesRegex("8:29: bodies.2..mesh: .*s.json:1:1: .* .and [0-9]+ more."),
                          StartsWith("9:17: generators[0]: its largest sphere's mass would be 4.19e+36 kg")));
  EXPECT_THAT(lines_of(begin + R"( "bodies": [{"shape": "mesh", "mesh": "none.obj"},
  {"shape": "mesh", "mesh": ".", "position": [5, 0, 0]}]})"),
              ElementsAre(MatchesRegex("2:39: bodies.0..mesh: .*none.obj: cannot be opened .*"),
                          MatchesRegex("3:29: bodies.1..mesh: .*: is a folder; .*")));
}

TEST(SceneFaults, OfASettingThatAFlagTurnsHaveALine) {
  EXPECT_THAT(lines_of(begin + " \"materials\": {\"default\": {\n  \"friction\": 0.5}},\n \"bodies\": [{}]}",
                       {"--solver", "impulse"}),
              ElementsAre(StartsWith("3:15: materials.default.friction: must be 0 with the solver impulse")));
}

TEST(SceneFaults, OfOtherFilesOfTheSameForm) {
  const TemporaryFolder folder;
  const std::string changes = folder / "c.json";
  std::ofstream(changes) << "{\"format\": \"collidoscope-changes\", \"version\": 1, \"changes\": [\n"
                            "{\"step\": 1, \"time_step\": NaN, \"substps\": 2}]}";
  const Outcome outcome = run_headless({"run", "one_body", "--changes", changes});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, StartsWith(changes + ":2:26: NaN is not a finite number; write a finite number\n" +
                                      changes + ":2:31: unknown key \"substps\""));
}

TEST(BvhCommand, SaysThatAnEmptySceneHasNoBodies) {
  const Outcome empty = run_headless({"bvh", "empty"});
  EXPECT_EQ(empty.status, 2);
  EXPECT_EQ(empty.err, "Empty: the scene has no bodies; expected at least one body\n");
  const Outcome treeless = run_headless({"bvh", "box_collider", "--bodies", "5", "--methods", "brute_force"});
  EXPECT_EQ(treeless.status, 2);
  EXPECT_EQ(treeless.err,
            "Box Collider: no tree to measure with brute_force; expected a method with a tree\n");
}

}  // namespace
}  // namespace collidoscope

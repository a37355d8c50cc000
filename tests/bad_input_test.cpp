// Tests bad input of the headless program: a clear line, the exit status, and no changed or partial file. The
// tests run the real program, as a user does.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <tuple>
#include <vector>

#include "tests/run_program.h"

namespace collidoscope {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

/// `text` is the content of the scene file; `@` in the arguments is the folder.
struct BadInput {
  std::string name;
  std::string text;  ///< content of @/scene.json; empty: the file does not exist
  std::vector<std::string> arguments;
  int status;
  std::string first_line;  ///< a regular expression (POSIX extended); @ as above
};

std::string in_folder(std::string text, const TemporaryFolder& folder) {
  for (std::size_t at; (at = text.find('@')) != std::string::npos;)
    text.replace(at, 1, folder.path().string());
  return text;
}

std::string one_sphere(const std::string& fields) {
  return R"({"format": "collidoscope-scene", "version": 1, "bodies": [{"shape": "sphere", )" + fields + "}]}";
}

void PrintTo(const BadInput& given, std::ostream* stream) { *stream << given.name; }

std::string name_of_case(const testing::TestParamInfo<BadInput>& given) { return given.param.name; }

class BadInputTest : public testing::TestWithParam<BadInput> {};

TEST_P(BadInputTest, IsOneClearLineAnExitStatusAndNothingElse) {
  const BadInput& given = GetParam();
  const TemporaryFolder folder;
  if (!given.text.empty()) std::ofstream(folder / "scene.json") << given.text;
  std::ofstream(folder / "kept.json") << "as it was";
  const auto before = folder.names();

  std::vector<std::string> arguments;
  for (const std::string& argument : given.arguments) arguments.push_back(in_folder(argument, folder));
  const Outcome outcome = run_headless(arguments);

  EXPECT_EQ(outcome.status, given.status);
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(outcome.err, EndsWith("\n"));
  ASSERT_FALSE(text_lines(outcome.err).empty());
  EXPECT_THAT(text_lines(outcome.err)[0], testing::MatchesRegex(in_folder(given.first_line, folder)));
  EXPECT_EQ(folder.names(), before);
  EXPECT_EQ(text_of(folder / "kept.json"), "as it was");
}

const std::string good_scene = one_sphere(R"("radius": 1, "position": [0, 0, 5])");
const std::vector<std::string> run_it{"run", "@/scene.json", "--steps", "2", "--json", "@/kept.json"};

std::vector<std::string> run_with(const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"run", "box_collider", "--steps", "2", "--dump-bodies", "@/kept.json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

INSTANTIATE_TEST_SUITE_P(
    Scene, BadInputTest,
    testing::Values(
        BadInput{"MissingFile", "", run_it, 2, "@/scene.json: .*(open|exist|No such file).*"},
        BadInput{"UnknownName",
                 "",
                 {"run", "no_such_scene"},
                 2,
                 "no_such_scene: neither a file nor the name of a scene; expected a file, or a name such as "
                 "box_collider .[0-9]+ scenes are in .*assets/scenes."},
        BadInput{"MisspeltName",
                 "",
                 {"run", "box_colider"},
                 2,
                 "box_colider: neither a file nor the name of a scene; did you mean \"box_collider\".*"},
        BadInput{"Folder", "", {"run", "@"}, 2, "@: .*"},
        BadInput{"BrokenJson", "{\n  \"format\": ", run_it, 2, "@/scene.json:2:[0-9]+: .+"},
        BadInput{"NotJson", "what", run_it, 2, "@/scene.json:1:[0-9]+: .+"},
        BadInput{"UnknownKey", one_sphere("\n\"radios\": 1"), run_it, 2, "@/scene.json:2:1: .*radios.*"},
        BadInput{"WrongType", one_sphere("\n\"radius\": \"1\""), run_it, 2, "@/scene.json:2:11: .*"},
        BadInput{"RadiusZero", one_sphere("\n\"radius\": 0"), run_it, 2, "@/scene.json:2:11: .*"},
        BadInput{"RadiusNegative", one_sphere("\n\"radius\": -2.5"), run_it, 2, "@/scene.json:2:11: .*"},
        BadInput{"NaN", one_sphere("\n\"radius\": NaN"), run_it, 2, "@/scene.json:2:[0-9]+: .*"},
        BadInput{"TooLargeForADouble", one_sphere("\n\"radius\": 1e999"), run_it, 2, "@/scene.json:2:11: .*"},
        BadInput{
            "TenBillionBodies",
            R"({"format": "collidoscope-scene", "version": 1, "box": {"min": [0, 0, 0], "max": [9, 9, 9]},
"generators": [{"kind": "box_collider",
"count": 10000000000}]})",
            run_it, 2, "@/scene.json:3:10: .*"}),
    name_of_case);

INSTANTIATE_TEST_SUITE_P(
    Flags, BadInputTest,
    testing::Values(
        BadInput{"NoCommand", "", {}, 2, "missing command, expected .*run, replay, capture.*"},
        BadInput{"UnknownCommand",
                 "",
                 {"simulate"},
                 2,
                 "simulate: unknown command, expected .*run, replay, capture.*"},
        BadInput{"HelpOfNoCommand",
                 "",
                 {"help", "simulate"},
                 2,
                 "help simulate: unknown command, expected run, .*"},
        BadInput{
            "HelpOfTwo", "", {"help", "run", "tune"}, 2, "tune: unexpected argument; usage: help .COMMAND."},
        BadInput{"Completion",
                 "",
                 {"help", "--completion", "y"},
                 2,
                 "y: unexpected argument; usage: help --completion"},
        BadInput{"ManPage", "", {"help", "--man", "run"}, 2, "help --man: run is no program, expected .*"},
        BadInput{"NoScene", "", {"run"}, 2, "run: missing file, expected run SCENE"},
        BadInput{"TwoScenes", "", {"run", "gas", "empty"}, 2, "empty: unexpected argument; usage: .*"},
        BadInput{"UnknownFlag", "", run_with({"--stepz", "3"}), 2, "--stepz: unknown flag; .*"},
        BadInput{"NoValue", "", run_with({"--bodies"}), 2, "--bodies: missing value"},
        BadInput{"Twice", "", run_with({"--seed", "1", "--seed", "2"}), 2,
                 "--seed: given 2 times, expected once"},
        BadInput{"NegativeBodies", "", run_with({"--bodies", "-5"}), 2,
                 "--bodies: -5 is not a whole number from 0 to 134217728"},
        BadInput{"TenBillion", "", run_with({"--bodies", "10000000000"}), 2,
                 "--bodies: 10000000000 is not a whole number from 0 to 134217728"},
        BadInput{"Fraction", "", run_with({"--bodies", "2.5"}), 2, "--bodies: 2.5 is not a whole number .*"},
        BadInput{"Trailing", "", run_with({"--bodies", "12x"}), 2, "--bodies: 12x is not a whole number .*"},
        BadInput{"EmptyNumber", "", run_with({"--bodies", ""}), 2, "--bodies: '' is not a whole number .*"},
        BadInput{"NaN", "", run_with({"--time-step", "nan"}), 2, "--time-step: nan is not a number .*"},
        BadInput{"Infinity", "", run_with({"--time-step", "inf"}), 2, "--time-step: inf is not a number .*"},
        BadInput{"Overflow", "", run_with({"--time-step", "1e999"}), 2,
                 "--time-step: 1e999 is not a number .*"},
        BadInput{"GravityOfTwo", "", run_with({"--gravity", "0,1"}), 2, "--gravity: 0,1 is not x,y,z.*"},
        BadInput{"GravityNaN", "", run_with({"--gravity", "0,0,nan"}), 2,
                 "--gravity: 0,0,nan is not x,y,z.*"},
        BadInput{"ThreadsBeyondAnyDevice", "", run_with({"--blocks", "4", "--threads", "1025"}), 2,
                 "--threads: 1025 is not a whole number from 1 to 1024, or auto"},
        BadInput{"BlocksBeyondAnyDevice", "", run_with({"--blocks", "2147483648"}), 2,
                 "--blocks: 2147483648 is not a whole number from 1 to 2147483647, or auto"},
        BadInput{
            "NoSuchDevice", "", run_with({"--executor", "cuda", "--gpu", "1023"}), 3,
            "the executor cuda cannot be used: .*CUDA.*|GPU 1023 does not exist: this machine has GPUs .*"},
        BadInput{"NoSuite", "", {"bench"}, 2, "bench: missing SUITE, expected one of .*frames.*"},
        BadInput{"UnknownSuite",
                 "",
                 {"bench", "fames"},
                 2,
                 "bench: unknown suite fames, expected one of .*frames.*"},
        BadInput{"NoFrames",
                 "",
                 {"bench", "frames", "--frames", "0"},
                 2,
                 "--frames: 0 is not a whole number from 1 to 1000000"},
        BadInput{"UnknownQuality",
                 "",
                 {"bench", "frames", "--quality", "best"},
                 2,
                 "--quality: 'best': .*auto, full, quick"},
        BadInput{"TooManySamples",
                 "",
                 {"bench", "frames", "--supersample", "5"},
                 2,
                 "--supersample: 5 is not a whole number from 1 to 4, or auto"},
        BadInput{"BenchOfTwoScenes",
                 "",
                 {"bench", "frames", "one_body", "empty"},
                 2,
                 "empty: unexpected argument; usage: bench SUITE .SCENE."},
        BadInput{"UnknownVariant", "", run_with({"--variant", "papr"}), 2,
                 "--variant: .*paper, scaled, settled or equal.*"},
        BadInput{"UnknownBroadPhase", "", run_with({"--broad-phase", "magic"}), 2,
                 "--broad-phase: .*bvh_bottom_up.*"},
        BadInput{"UnknownEffect", "", run_with({"--effects", "gravity,magic"}), 2,
                 "--effects: .*rotation,friction.*"},
        BadInput{"BodiesWithoutGenerator",
                 good_scene,
                 {"run", "@/scene.json", "--bodies", "7", "--json", "@/kept.json"},
                 2,
                 "--bodies: @/scene.json has no generators, expected exactly one"},
        BadInput{"FaultOfTwoFlagsTogether", "", run_with({"--time-step", "1e-9", "--substeps", "0"}), 2,
                 "--substeps: 0 is not a whole number from 1 to 1000, or auto"}),
    name_of_case);

INSTANTIATE_TEST_SUITE_P(
    Files, BadInputTest,
    testing::Values(
        BadInput{"FolderMissing", "", run_with({"--json", "@/none/x.json"}), 2,
                 "--json: @/none/x.json cannot be written: .*"},
        BadInput{"FolderIsAFile", "", run_with({"--json", "@/kept.json/x"}), 2,
                 "--json: @/kept.json/x cannot be written: .*"},
        BadInput{"FolderUnwritable", "", run_with({"--json", "/proc/x.json"}), 2,
                 "--json: /proc/x.json cannot be written: .*"},
        BadInput{"IsAFolder", "", run_with({"--json", "@"}), 2,
                 "--json: @ cannot be written: it is a folder.*"},
        BadInput{"OneFileForTwo", "", run_with({"--json", "@/kept.json"}), 2,
                 "--dump-bodies: @/kept.json is also the file of --json, expected a different file"},
        BadInput{"OverTheScene",
                 good_scene,
                 {"run", "@/scene.json", "--json", "@/./scene.json"},
                 2,
                 "--json: .* is also the file of the scene, expected a different file"},
        BadInput{"DiskFull",
                 "",
                 {"run", "box_collider", "--steps", "1", "--json", "/dev/full"},
                 3,
                 "--json: /dev/full cannot be written: No space left on device"},
        BadInput{"CaptureFolder",
                 "",
                 {"capture", "box_collider", "--states", "0", "--out", "/proc/pictures"},
                 2,
                 "--out: .*/proc/pictures.*"},
        BadInput{"CompareMissing", "", {"compare", "@/a.png", "@/b.png"}, 2, "@/a.png: .*"},
        BadInput{"CompareNoPng", "", {"compare", "@/kept.json", "@/kept.json"}, 2, "@/kept.json: .*"},
        BadInput{"CompareOne",
                 "",
                 {"compare", "@/a.png"},
                 2,
                 "compare: missing file, expected compare A.png B.png"}),
    name_of_case);

TEST(FaultsOfCommands, EveryFaultOfACommandLineIsNamedInOneRun) {
  const Outcome outcome =
      run_headless({"run", "box_collider", "--bodies", "x", "--threads", "0", "--nonsense"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(text_lines(outcome.err).size(), 3u) << outcome.err;
}

TEST(FaultsOfCommands, ControlCharactersOfAnArgumentDoNotReachTheTerminal) {
  const Outcome outcome = run_headless({"run", "box_collider", "--bodies", "1\n\x1b[2J"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(text_lines(outcome.err).size(), 1u);
  EXPECT_EQ(outcome.err.find('\x1b'), std::string::npos);
}

TEST(FaultsOfCommands, ControlCharactersOfAFilesNameDoNotReachTheTerminal) {
  const Outcome outcome = run_headless({"run", "/nowhere\n\x1b[2J/s.json"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, testing::StartsWith("/nowhere??[2J/s.json: "));
  EXPECT_EQ(text_lines(outcome.err).size(), 1u);
}

TEST(FaultsOfCommands, TwentyFaultsArePrintedAndTheRestCounted) {
  const TemporaryFolder folder;
  std::ofstream scene(folder / "scene.json");
  scene << R"({"format": "collidoscope-scene", "version": 1, "bodies": [)";
  for (int i = 0; i < 27; ++i) scene << (i ? "," : "") << R"({"shape": "sphere", "radius": -1})";
  scene << "]}";
  scene.close();
  const Outcome outcome = run_headless({"run", folder / "scene.json"});
  EXPECT_EQ(outcome.status, 2);
  const auto lines = text_lines(outcome.err);
  ASSERT_EQ(lines.size(), 21u);
  EXPECT_EQ(lines[20], "and 7 more errors");
}

TEST(FaultsOfCommands, ASuiteRefusesFlagsThatItDoesNotRead) {
  for (const auto& [suite, flag, value] : {std::tuple{"frames", "--csv", "x"},
                                           {"frames", "--sizes", "10"},
                                           {"solvers", "--plot", "x.png"},
                                           {"solvers", "--methods", "brute_force"},
                                           {"effects", "--variants", "paper"},
                                           {"paper", "--frames", "3"}}) {
    const Outcome outcome = run_headless({"bench", suite, flag, value});
    EXPECT_EQ(outcome.status, 2) << suite << flag;
    EXPECT_THAT(outcome.err,
                testing::StartsWith(std::string(flag) + ": not a flag of bench " + suite + ", expected --"));
  }
}

TEST(FaultsOfCommands, OldNamesOfFlagsAreAcceptedWithAWarning) {
  const Outcome old =
      run_headless({"run", "one_body", "--steps", "1", "--executor", "cpu", "--lane-order=strided"});
  EXPECT_EQ(old.status, 0);
  EXPECT_EQ(old.err, "--lane-order: renamed to --cpu-item-order; the old name is still accepted\n");
  const std::string help = run_headless({"stability", "--help"}).out;
  EXPECT_THAT(help, HasSubstr("--inject-faults "));
  EXPECT_THAT(help, testing::Not(HasSubstr("--plant")));
}

TEST(FaultsOfCommands, AllFaultsAreReportedAtOnce) {
  const Outcome outcome =
      run_headless({"run", "gas", "extra", "--bodies", "-5", "--friction=nan", "--residuals=3", "--nope",
                    "--seed", "1", "--seed", "2", "--json", "", "--steps"});
  EXPECT_EQ(outcome.status, 2);
  const std::vector<std::string> lines = text_lines(outcome.err);
  EXPECT_EQ(lines.size(), 8u) << outcome.err;
  for (const char* line : {"--steps: missing value", "--bodies: -5 is not a whole number from 0 to 134217728",
                           "--residuals: takes no value; remove 3", "--seed: given 2 times, expected once",
                           "--json: '' is not the name of a file"})
    EXPECT_THAT(lines, testing::Contains(line));
}

TEST(FaultsOfCommands, NamesInErrorsHoldNothingThatATerminalObeys) {
  const Outcome outcome = run_headless({"run",
                                        "a\u009Bb\u202Ec\x9b"
                                        "d\u00e9"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, testing::StartsWith("a?b?c?d\u00e9: neither"));
}

TEST(FaultsOfCommands, AnEmptyNameToLoadIsTheOnlyFault) {
  const Outcome outcome = run_headless({"run", "--load", ""});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(text_lines(outcome.err).size(), 1u) << outcome.err;
  const Outcome unknown = run_headless({"stability", "nosuch"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.err, testing::ContainsRegex("unknown hard case \"nosuch\"; there are [0-9]+\n"));
}

}  // namespace
}  // namespace collidoscope

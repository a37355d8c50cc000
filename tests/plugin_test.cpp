// Tests broad-phase plug-ins from outside: a C compiler builds them in an empty folder, and the program loads
// them. tests/plugins/plugin.c has a fault for each test.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/executor_options.h"
#include "sim_cuda/plugin/include/collidoscope/broad_phase.h"
#include "sim_cuda/plugin/library.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "tests/npy_file.h"
#include "tests/random.h"
#include "tests/run_program.h"

namespace collidoscope {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

class Plugins : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(compiler) ||
        !std::filesystem::exists(project_file("tests/plugins/plugin.c")))
      GTEST_SKIP() << "no C compiler, or no sources beside a bundle";
  }

  /// Compiles a source with options such as -DFAULT=CRASH. Returns the path of the library.
  std::string build(const std::string& source, const std::string& name,
                    std::vector<std::string> options = {}) {
    const std::string library = folder_ / ("lib" + name + ".so");
    std::vector<std::string> arguments{"-std=c99", "-D_GNU_SOURCE", "-Wall",   "-Wextra", "-Wpedantic",
                                       "-Werror",  "-O2",           "-shared", "-fPIC"};
    arguments.insert(arguments.end(), {"-I", project_file("sim_cuda/plugin/include"), "-o", library});
    arguments.insert(arguments.end(), options.begin(), options.end());
    arguments.push_back(project_file(source));
    const Outcome compiled = run_program(compiler, arguments);
    EXPECT_EQ(compiled.status, 0) << compiled.err;
    return library;
  }
  std::string build_with(const std::string& fault) {
    return build("tests/plugins/plugin.c", fault, {"-DFAULT=" + fault});
  }

  static Outcome run(const std::vector<std::string>& flags) {
    std::vector<std::string> arguments{"run",       "box_collider", "--bodies",   "300",
                                       "--variant", "scaled",       "--executor", "cpu"};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    if (std::ranges::find(flags, "--steps") == flags.end())
      arguments.insert(arguments.end(), {"--steps", "5"});
    return run_headless(arguments);
  }
  static json report(const std::vector<std::string>& flags) {
    std::vector<std::string> arguments(flags);
    arguments.insert(arguments.end(), {"--json", "-"});
    const Outcome outcome = run(arguments);
    return json::parse(outcome.out, nullptr, false);
  }

  static constexpr const char* compiler = "/usr/bin/cc";
  TemporaryFolder folder_;
};

TEST_F(Plugins, TheExampleGivesTheSameState) {
  const std::string library = build("sim_cuda/plugin/examples/sweep_and_prune.c", "sap");
  const json expected = report({});
  for (const char* capacity : {"auto", "1"}) {
    const json found =
        report({"--broad-phase", library, "--check-pairs", "on", "--initial-pair-capacity", capacity});
    ASSERT_TRUE(found.is_object());
    EXPECT_EQ(found["state_hash"], expected["state_hash"]);
    EXPECT_EQ(found["pairs"], expected["pairs"]);
    EXPECT_EQ(found["broad_phase"], "sweep_and_prune");
    const json& check = found["pair_check"];
    EXPECT_EQ(check["plugin"], library);
    EXPECT_EQ(check["compared"], true);
    EXPECT_EQ(check["missing"], 0);
    EXPECT_GE(check["runs"].get<int>(), 5);
    std::vector<std::string> stages;
    for (const json& stage : found["stages"]) stages.push_back(stage["name"]);
    EXPECT_THAT(stages, testing::IsSupersetOf({"sort", "sweep", "canonical", "compare", "contacts"}));
  }
  const Outcome text = run({"--broad-phase", library});
  EXPECT_EQ(text.status, 0);
  EXPECT_THAT(text.out, HasSubstr("sweep_and_prune (plug-in, pairs not compared)"));
  EXPECT_THAT(text.err, HasSubstr("tests passed"));
}

TEST_F(Plugins, FindThePairsOfForeignBoxes) {
  Uniform random{Random(3)};
  std::vector<float> numbers;
  for (int box = 0; box < 400; ++box) {
    float low[3], high[3];
    for (int k = 0; k < 3; ++k) {
      low[k] = static_cast<float>(random(0, 10));
      high[k] = low[k] + static_cast<float>(random(0, 2));
    }
    numbers.insert(numbers.end(), low, low + 3);
    numbers.insert(numbers.end(), high, high + 3);
  }
  int pairs = 0;
  for (std::size_t a = 0; a < numbers.size(); a += 6)
    for (std::size_t b = a + 6; b < numbers.size(); b += 6) {
      bool overlap = true;
      for (std::size_t k = 0; k < 3; ++k)
        overlap &= numbers[a + k] <= numbers[b + k + 3] && numbers[b + k] <= numbers[a + k + 3];
      pairs += overlap;
    }
  const Outcome outcome =
      run_headless({"bvh", "--boxes", box_file(folder_ / "boxes.npy", numbers), "--methods",
                    build("sim_cuda/plugin/examples/sweep_and_prune.c", "sap") + "," + build_with("TREE"),
                    "--executor", "cpu", "--repeats", "1", "--json", "-"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json found = json::parse(outcome.out);
  ASSERT_EQ(found["methods"].size(), 2u);
  for (const json& method : found["methods"]) {
    EXPECT_EQ(method["pairs"], pairs);
    EXPECT_EQ(method["agrees"], true);
  }
  ASSERT_EQ(found["trees"].size(), 1u) << "the other library has no tree";
  EXPECT_EQ(found["trees"][0]["method"], "test_plugin");
  EXPECT_EQ(found["trees"][0]["nodes"], 400 + 50 + 7 + 1);
}

TEST_F(Plugins, AppearBesideTheBuiltInMethods) {
  const Outcome outcome =
      run_headless({"bench", "broad-phases", "--broad-phase", build_with("NONE"), "--sizes", "50",
                    "--variants", "equal", "--repeats", "1", "--executor", "cpu"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("lbvh_ropes"));
  EXPECT_THAT(outcome.out, HasSubstr("test_plugin"));
  EXPECT_THAT(outcome.out, HasSubstr("pairs not compared"));
}

struct WrongPairs {
  const char *fault, *text, *field;
};
class WrongPlugins : public Plugins, public testing::WithParamInterface<WrongPairs> {};

TEST_P(WrongPlugins, AreFoundAndListed) {
  const auto [fault, text, field] = GetParam();
  const std::string library = build_with(fault);
  const Outcome validation = run_headless({"validate", library});
  EXPECT_EQ(validation.status, 1);
  EXPECT_THAT(validation.out, HasSubstr(text));
  const Outcome outcome = run({"--broad-phase", library, "--json", "-"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("tests failed; its pairs are compared"));
  EXPECT_THAT(outcome.err, HasSubstr("broad phase test_plugin: wrong pairs: "));
  const json check = json::parse(outcome.out)["pair_check"];
  EXPECT_GT(check[field].get<std::uint64_t>(), 0u) << check;
  EXPECT_GT(check["wrong_runs"].get<int>(), 0);
  EXPECT_EQ(check["compared"], true);
}
INSTANTIATE_TEST_SUITE_P(
    Plugins, WrongPlugins,
    testing::Values(WrongPairs{"MISSING", "missing", "missing"},
                    WrongPairs{"DUPLICATE", "duplicate", "duplicate"},
                    WrongPairs{"OUT_OF_RANGE", "out of range, such as 0-", "out_of_range"},
                    WrongPairs{"SELF", "out of range, such as 0-0", "out_of_range"},
                    WrongPairs{"BEYOND", "writes beyond the capacity", "writes_beyond"},
                    WrongPairs{"ABSURD", "more pairs than a list can have", "absurd_counts"}),
    [](const auto& test) { return std::string(test.param.fault); });

TEST_F(Plugins, WithMissingPairsFailACapture) {
  const Outcome outcome =
      run_headless({"capture", "box_collider", "--bodies", "300", "--variant", "scaled", "--states", "1",
                    "--size", "160x100", "--executor", "cpu", "--broad-phase", build_with("MISSING"), "--out",
                    folder_ / "pictures"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("broad phase test_plugin: wrong pairs: "));
  EXPECT_THAT(outcome.out, HasSubstr("WRONG PAIRS"));
}

TEST_F(Plugins, MissingPairsAreListedWithTheirIds) {
  const json found = report({"--broad-phase", build_with("MISSING"), "--steps", "0"});
  const json& check = found["pair_check"];
  ASSERT_GT(check["examples"].size(), 0u);
  for (const json& pair : check["examples"]) {
    EXPECT_EQ(pair["fault"], "missing");
    EXPECT_EQ((pair["a"].get<int>() + pair["b"].get<int>()) % 7, 0) << pair;
  }
}

TEST_F(Plugins, DuplicatesAndPairsApartDoNotChangeTheState) {
  const json expected = report({});
  const json duplicate = report({"--broad-phase", build_with("DUPLICATE")});
  EXPECT_EQ(duplicate["state_hash"], expected["state_hash"]);
  EXPECT_EQ(duplicate["pairs"], expected["pairs"]);
  const Outcome outcome = run({"--broad-phase", build_with("APART"), "--json", "-"});
  EXPECT_EQ(outcome.status, 0) << "boxes apart are left out, and are no error";
  const json apart = json::parse(outcome.out);
  EXPECT_EQ(apart["state_hash"], expected["state_hash"]);
  EXPECT_EQ(apart["pairs"], expected["pairs"]);
  EXPECT_GT(apart["pair_check"]["apart"].get<int>(), 0);
}

struct Refused {
  const char* name;
  std::vector<std::string> options;
  const char* text;
};
class RefusedPlugins : public Plugins, public testing::WithParamInterface<Refused> {};

// The address sanitizer catches the signal, and ends the process.
#ifdef WITH_SANITIZER
constexpr const char* text_of_crash = "ended with exit status 1 in the test a line (cpu), 300 boxes";
#else
constexpr const char* text_of_crash = "crashed with Segmentation fault in the test a line (cpu), 300 boxes";
#endif

TEST_P(RefusedPlugins, AreNotLoaded) {
  const std::string library = build("tests/plugins/plugin.c", "refused", GetParam().options);
  const Outcome outcome = run({"--broad-phase", library});
  EXPECT_EQ(outcome.status, 2) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr(library));
  EXPECT_THAT(outcome.err, HasSubstr(GetParam().text));
  EXPECT_EQ(outcome.out, "");
}
INSTANTIATE_TEST_SUITE_P(
    Plugins, RefusedPlugins,
    testing::Values(
        Refused{"Crash", {"-DFAULT=CRASH"}, text_of_crash},
        Refused{"Exit", {"-DFAULT=EXIT"}, "ended with exit status 5 in the test a line"},
        Refused{"Version", {"-DVERSION=2"}, "version 2 of collidoscope/broad_phase.h, expected 1"},
        Refused{"Name", {"-DNAME=\"Bad Name\""}, "a name that is not 1 to 32 of a-z, 0-9 and _"},
        Refused{"BuiltInName", {"-DNAME=\"kd_tree\""}, "already a broad phase with the name kd_tree"},
        Refused{"Memory", {"-DMEMORY=8"}, "memory 8, expected COLLIDOSCOPE_HOST"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST_F(Plugins, ThatHangAreEnded) {
  const std::string library = build_with("HANG");
  const auto start = std::chrono::steady_clock::now();
  const Outcome outcome = run_headless({"validate", library, "--timeout", "1"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, HasSubstr("no answer for 1 s in the test a line"));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(15));
}

TEST_F(Plugins, ThatFailAreReported) {
  for (const auto& [fault, text] : {std::pair("STATUS", "failed to find pairs, with status 7"),
                                    std::pair("NO_OBJECT", "cannot create an object")}) {
    const std::string library = build_with(fault);
    const Outcome validation = run_headless({"validate", library});
    EXPECT_EQ(validation.status, 1);
    EXPECT_THAT(validation.out, HasSubstr(text));
    EXPECT_EQ(run({"--broad-phase", library}).status, 3);
  }
}

TEST_F(Plugins, TreesAreCheckedNodeByNode) {
  const Outcome good = run_headless({"validate", build_with("TREE")});
  EXPECT_EQ(good.status, 0) << good.out;
  const Outcome bad = run_headless({"validate", build_with("BAD_TREE")});
  EXPECT_EQ(bad.status, 1);
  EXPECT_THAT(bad.out, HasSubstr("tree: node 2: box 1 is already that of node 1"));
}

TEST_F(Plugins, WrongFilesAreBadInput) {
  std::ofstream(folder_ / "text.so") << "not a library";
  for (const std::string& name : {std::string(folder_ / "text.so"), std::string(folder_ / "none.so"),
                                  std::string("./none.so"), folder_.path().string()}) {
    const Outcome outcome = run({"--broad-phase", name});
    EXPECT_EQ(outcome.status, 2) << name;
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("--broad-phase: "));
  }
  const Outcome built_in = run({"--check-pairs", "on"});
  EXPECT_EQ(built_in.status, 2);
  EXPECT_THAT(built_in.err, HasSubstr("--check-pairs: lbvh_ropes is built in"));
}

TEST_F(Plugins, AreNeverLoadedByFiles) {
  const std::string library = build_with("NONE");
  const std::string recording = folder_ / "run.rec";
  ASSERT_EQ(run({"--broad-phase", library, "--record", recording}).status, 0);
  const Outcome replayed = run_headless({"replay", recording, "--executor", "cpu"});
  EXPECT_EQ(replayed.status, 0) << replayed.err;
  EXPECT_THAT(replayed.err, Not(HasSubstr("plug-in")));
  EXPECT_THAT(replayed.out, Not(HasSubstr("test_plugin")));
  const std::string changes = folder_ / "changes.json";
  std::ofstream(changes) << R"({"changes": [{"step": 1, "settings": {"broad_phase": ")" << library
                         << "\"}}]}";
  const Outcome changed = run({"--changes", changes});
  EXPECT_EQ(changed.status, 2) << changed.err;
}

/// In a process of its own, which ends with 0 if all is as expected: the methods of the tests stay the same.
TEST_F(Plugins, ThatChangedAreLoadedAgain) {
  const std::string library = build_with("NONE"), path = full_plugin_path(library);
  const std::string tested = file_identity(path);
  const auto exit_status = [&] {
    const auto has_tree = [] { return find_broad_phase("test_plugin")->plugin->tree != nullptr; };
    if (load_plugin(path, tested, false) != "test_plugin" || has_tree()) return 1;
    std::filesystem::remove(library);
    build("tests/plugins/plugin.c", "NONE", {"-DFAULT=TREE"});
    try {
      load_plugin(path, tested, false);
      return 2;
    } catch (const InputError& error) {
      if (std::string(error.what()).find("changed while it was tested") == std::string::npos) return 3;
    }
    if (load_plugin(path, file_identity(path), false) != "test_plugin" || !has_tree()) return 4;
    return std::ranges::count(broad_phase_names(), "test_plugin") == 1 ? 0 : 5;
  };
  // Without exit handlers: the leak checker would report leaks of the OpenGL driver, if an earlier test drew.
  EXPECT_EXIT(std::_Exit(exit_status()), testing::ExitedWithCode(0), "");
}

/// The CUDA example, which the build of the tests makes out of tree if there is nvcc.
TEST(CudaPlugins, TheExampleGivesTheSameState) {
  if (!cuda_available()) GTEST_SKIP() << "no CUDA device";
  const std::string library = program_folder() / "plugins" / "libcuda_grid.so";
  const auto report = [](std::vector<std::string> flags) {
    std::vector<std::string> arguments{"run",     "box_collider", "--bodies",   "3000", "--variant", "scaled",
                                       "--steps", "20",           "--executor", "cuda", "--json",    "-"};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    const Outcome outcome = run_headless(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return json::parse(outcome.out, nullptr, false);
  };
  const json expected = report({});
  for (const char* capacity : {"auto", "1"}) {
    const json found =
        report({"--broad-phase", library, "--check-pairs", "on", "--initial-pair-capacity", capacity});
    EXPECT_EQ(found["state_hash"], expected["state_hash"]);
    EXPECT_EQ(found["pairs"], expected["pairs"]);
    EXPECT_EQ(found["pair_check"]["missing"], 0);
  }
  const Outcome validation = run_headless({"validate", library});
  EXPECT_EQ(validation.status, 0) << validation.out;
}

}  // namespace
}  // namespace collidoscope

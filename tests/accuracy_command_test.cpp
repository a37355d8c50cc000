// Tests `accuracy SCENE` through the real program: output files, exit status and Ctrl-C. Expected texts and
// statuses are fixed, since scripts depend on them.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "sim_cuda/accuracy/record.h"
#include "tests/run_program.h"

namespace collidoscope {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// Command line of a short study: 20 falling spheres for 0.2 s.
std::vector<std::string> falling(const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"accuracy",   "box_collider", "--bodies",      "20",
                                     "--seconds",  "0.2",          "--repeats",     "1",
                                     "--executor", "cpu",          "--cpu-threads", "1"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(AccuracyCommand, WritesTableFilesAndChart) {
  const TemporaryFolder folder;
  AccuracyRecord older;  // an interrupted study, which is replaced
  older.physics_version = 1;
  std::ofstream(folder / "a.json") << write_record(older);
  const Outcome outcome =
      run_headless(falling({"--tolerance", "0.02", "--json", folder / "a.json", "--csv", folder / "a.csv",
                            "--markdown", folder / "a.md", "--plot", folder / "a.png"}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("start apart"));
  EXPECT_THAT(outcome.err, HasSubstr("a.json was written by physics version 1; this program has version "));
  EXPECT_THAT(outcome.out, HasSubstr("reference: event-driven hard spheres"));
  EXPECT_THAT(outcome.out, HasSubstr("soft_step semi_implicit_euler f64, observed order 1.0"));
  EXPECT_THAT(outcome.out, HasSubstr("fastest setting within 0.02 m: "));
  const AccuracyRecord record = parse_record(text_of(folder / "a.json"), "a.json");
  EXPECT_TRUE(record.complete);
  EXPECT_EQ(record.bodies, 20);
  EXPECT_EQ(record.executor.substr(0, 15), "CPU, 1 thread: ");
  EXPECT_EQ(write_record(record), text_of(folder / "a.json"));
  // The size of the front depends on measured times. It is one point if the fastest setting is the best.
  std::vector<AccuracyPoint> marked = record.points;
  mark_front(marked);
  std::size_t rings = 0;
  for (std::size_t k = 0; k < marked.size(); ++k) {
    EXPECT_TRUE(record.points[k].has_error() && record.points[k].has_cost());
    EXPECT_EQ(record.points[k].on_front, marked[k].on_front) << record.points[k].name;
    rings += record.points[k].on_front;
  }
  EXPECT_GE(rings, 1u);
  const std::string csv = text_of(folder / "a.csv");
  EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), record.points.size() + 1);
  EXPECT_THAT(text_of(folder / "a.md"), HasSubstr("| setting |"));
  EXPECT_EQ(text_of(folder / "a.png").substr(1, 3), "PNG");
}

TEST(AccuracyCommand, SaysWhereNoSettingIsGoodEnough) {
  const Outcome outcome = run_headless(falling({"--tolerance", "1e-15"}));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, HasSubstr("no setting can be recommended: the allowed error of 1e-15 m is below "
                                     "the error of the reference, "));
}

// Spheres that overlap at the start separate chaotically. No reference converges for this scene.
TEST(AccuracyCommand, RecommendsNothingBelowTheReferencesOwnError) {
  const TemporaryFolder folder;
  const auto write_crowd = [&](int seed) {
    std::ofstream(folder / "crowd.json") << R"({"format": "collidoscope-scene", "version": 1,
      "name": "Crowd", "steps_per_second": 4, "box": {"min": [0, 0, 0], "max": [8, 8, 8]},
      "generators": [{"kind": "box_collider", "count": 12, "radius_max": 4, "variant": "paper",
                      "spawn": "inside", "seed": )"
                                         << seed << "}]}";
  };
  const auto run_with = [&](double tolerance) {
    return run_headless({"accuracy", folder / "crowd.json", "--seconds", "0.5", "--repeats", "1",
                         "--executor", "cpu", "--cpu-threads", "1", "--tolerance",
                         fmt::format("{}", tolerance), "--json", folder / "a.json"});
  };
  // Most seeds give a chaotic course, in which some settings differ from the reference by less than its own
  // error.
  AccuracyRecord record;
  double least = 0;
  for (int seed = 1; seed <= 8 && !(least < 0.8 * record.reference.error); ++seed) {
    write_crowd(seed);
    ASSERT_EQ(run_with(100).err, "");
    record = parse_record(text_of(folder / "a.json"), "a.json");
    least = record.points[0].error;
    for (const AccuracyPoint& p : record.points) least = std::min(least, p.error);
  }
  ASSERT_LT(least, 0.8 * record.reference.error);
  // The errors are of the chaos, so the tolerance between them is chosen after the first run.
  const double tolerance = (least + record.reference.error) / 2;
  const Outcome outcome = run_with(tolerance);
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("no setting can be recommended: "));
  EXPECT_THAT(outcome.out, HasSubstr("below the error of the reference, "));
  EXPECT_THAT(outcome.out, testing::Not(HasSubstr("fastest setting within")));
}

TEST(AccuracyCommand, KeepsASceneThatWasAskedForAsItIs) {
  const Outcome outcome = run_headless(falling({"--spawn", "inside", "--json", "-"}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const json result = json::parse(outcome.out);
  EXPECT_EQ(result["suite"], "accuracy");
  EXPECT_GT(result["points"].size(), 50u);
}

TEST(AccuracyCommand, RefusesWhatItCannotMeasure) {
  EXPECT_EQ(run_headless({"accuracy", "no_such_scene"}).status, 2);
  EXPECT_EQ(run_headless({"accuracy", "empty"}).status, 2);
  EXPECT_THAT(run_headless({"accuracy", "empty"}).err, HasSubstr("no dynamic body"));
  EXPECT_EQ(run_headless({"accuracy", "gas", "pile"}).status, 2);
  for (const char* flag : {"--tolerance", "--seconds"})
    for (const char* value : {"-1", "0", "nan", "much"}) {
      const Outcome outcome = run_headless({"accuracy", "gas", flag, value});
      EXPECT_EQ(outcome.status, 2) << flag << value;
      EXPECT_THAT(outcome.err, testing::StartsWith(std::string(flag) + ": "));
    }
}

TEST(AccuracyCommand, RefusesSecondsThatOneStepExceeds) {
  const Outcome outcome = run_headless({"accuracy", "gas", "--time-step", "2", "--seconds", "3"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.err,
            "--seconds: 3 s is shorter than the largest tested step, 4 s; expected at least 4 s\n");
}

TEST(AccuracyCommand, GoesOnAfterCtrlC) {
  const TemporaryFolder folder;
  const std::string file = folder / "a.json";
  const auto arguments = [&] {
    std::vector<std::string> list{
        "accuracy",  "box_collider", "--bodies",   "100", "--json",        file, "--repeats", "4",
        "--seconds", "0.3",          "--executor", "cpu", "--cpu-threads", "1"};
    return list;
  }();
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const int nowhere = open("/dev/null", O_RDWR);
    for (const int to : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, to);
    const std::string program = program_folder() / "collidoscope-headless";
    std::vector<char*> argv{const_cast<char*>(program.c_str())};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    execv(program.c_str(), argv.data());
    _exit(127);
  }
  // The program rewrites the files once a second, so the test polls them.
  for (int k = 0; k < 30000 && text_of(file).find("\"measured\":true") == std::string::npos; ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  kill(child, SIGINT);
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGINT);
  const AccuracyRecord kept = parse_record(text_of(file), "a.json");
  EXPECT_FALSE(kept.complete);

  const Outcome outcome = run_headless(arguments);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("already has the results of "));
  const AccuracyRecord whole = parse_record(text_of(file), "a.json");
  EXPECT_TRUE(whole.complete);
  ASSERT_EQ(whole.points.size(), kept.points.size());
  for (std::size_t k = 0; k < kept.points.size(); ++k) {
    EXPECT_EQ(whole.points[k].ms_runs.size(), 4u);
    if (!kept.points[k].has_error()) continue;
    EXPECT_EQ(whole.points[k].error, kept.points[k].error);
    for (std::size_t run = 0; run < kept.points[k].ms_runs.size(); ++run)
      EXPECT_EQ(whole.points[k].ms_runs[run], kept.points[k].ms_runs[run]);
  }
}

}  // namespace
}  // namespace collidoscope

// Tests `stability` through the real program: tables, files, exit status and Ctrl-C. The whole suite runs in
// CI.

#include "headless/stability/stability.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "sim_cuda/snapshot/snapshot.h"
#include "sim_cuda/world.h"
#include "tests/run_program.h"

namespace collidoscope {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// A folder with one case: a sphere that exceeds 5 m/s after half a second of free fall.
class StabilityCommand : public testing::Test {
 protected:
  void write_case(const std::string& criterion) {
    std::ofstream(folder_ / "fall.json")
        << R"({"format": "collidoscope-scene", "version": 1, "steps_per_second": 100,
      "gravity": [0, 0, -10], "bodies": [{"radius": 1, "position": [0, 0, 0]}]})";
    std::ofstream(folder_ / "fall.criterion.json") << R"({"format": "collidoscope-criterion", "version": 1,
      "what": "it falls slowly", "group": "speed", )"
                                                   << criterion << "}";
  }
  Outcome stability(std::vector<std::string> more) {
    more.insert(more.begin(), {"stability", "--executor", "cpu", "--cases", folder_.path().string()});
    return run_headless(more);
  }
  TemporaryFolder folder_;
};

TEST(Stability, TheQuickCasesHoldAndTheirFaultsShow) {
  const std::vector<std::string> quick{"stability", "ball_at_rest", "head_on", "moved_away", "radius_zero"};
  const Outcome outcome = run_headless(quick);
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  // On a GPU, cases refused by the reader are not repeated.
  EXPECT_THAT(outcome.out,
              HasSubstr(cuda_available() ? "18 trials of 4 cases on " : "19 trials of 4 cases on "));
  std::vector<std::string> injected = quick;
  injected.emplace_back("--inject-faults");
  const Outcome faults = run_headless(injected);
  EXPECT_EQ(faults.status, 0) << faults.out << faults.err;
  EXPECT_THAT(faults.out, HasSubstr("all detected"));
}

TEST_F(StabilityCommand, FailsWhereACaseDoes) {
  write_case(R"("steps": 100, "assertions": [{"quantity": "speed", "at_most": 5.05}])");
  const Outcome outcome =
      stability({"--json", folder_ / "out" / "r.json", "--save-failures", folder_ / "out"});
  EXPECT_EQ(outcome.status, 2) << "a folder that is not there";
  const Outcome again =
      stability({"--json", folder_ / "r.json", "--save-failures", folder_ / "out", "--jobs", "2"});
  EXPECT_EQ(again.status, 1);
  EXPECT_THAT(again.out,
              HasSubstr("fall, soft_step f32: speed at most 5.05 m/s: 5.1 m/s at state 51, body 0"));
  EXPECT_THAT(again.out, HasSubstr("6 trials of 1 case on "));
  const json result = json::parse(text_of(folder_ / "r.json"));
  EXPECT_EQ(result["failed"], 6);
  EXPECT_EQ(result["trials"][0]["failing_state"], 51);
  const std::string kept = folder_ / "out" / "fall-soft_step-f64.snapshot";
  EXPECT_THAT(again.err, HasSubstr("fall, soft_step f64: state 50; reproduce the failure with run --load " +
                                   kept + " --steps 1"));
  EXPECT_EQ(read_snapshot(kept).state.steps, 50);
}

TEST_F(StabilityCommand, ChoosesSolversAndPrecisions) {
  write_case(R"("steps": 3)");
  const Outcome outcome =
      stability({"fall", "--solver", "jacobi_split", "--precision", "f64", "--json", "-"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json result = json::parse(outcome.out);
  ASSERT_EQ(result["trials"].size(), 1u);
  EXPECT_EQ(result["trials"][0]["solver"], "jacobi_split");
  EXPECT_EQ(result["trials"][0]["precision"], "f64");
}

TEST_F(StabilityCommand, SaysWhichFaultShowsNowhere) {
  write_case(R"("steps": 30, "assertions": [{"quantity": "speed", "at_most": 5.05}], "injected_faults": [
    {"fails": "speed", "step": 3, "body": 0, "velocity": [6, 0, 0]},
    {"fails": "speed", "step": 3, "body": 0, "velocity": [1, 0, 0]}])");
  const Outcome outcome = stability({"--inject-faults"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, HasSubstr("passed despite fault 2"));
  EXPECT_THAT(outcome.out, HasSubstr("2 faults injected: 1 not detected"));
}

TEST_F(StabilityCommand, RefusesWhatItCannotDo) {
  write_case(R"("steps": 3)");
  EXPECT_THAT(stability({"fal"}).err, HasSubstr("unknown hard case \"fal\"; expected \"fall\""));
  const std::vector<std::vector<std::string>> bad{{"fal"},
                                                  {"--jobs", "0"},
                                                  {"--cases", "nowhere"},
                                                  {"--write-table", "r.md"},
                                                  {"--from", "a"},
                                                  {"--inject-faults", "--solver", "impulse"},
                                                  {"--write-table", "r", "--from", "a", "fall"}};
  for (const std::vector<std::string>& arguments : bad) {
    const Outcome outcome = stability(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments[0];
    EXPECT_EQ(outcome.out, "") << arguments[0];
  }
}

TEST_F(StabilityCommand, TellsWhatIsKnownAtCtrlC) {
  write_case(R"("steps": 1000000000, "every": 1000000000)");
  const std::string out = folder_ / "out", program = program_folder() / "collidoscope-headless";
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const int file = open(out.c_str(), O_WRONLY | O_CREAT, 0600), nowhere = open("/dev/null", O_RDWR);
    dup2(nowhere, STDIN_FILENO);
    dup2(file, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    execl(program.c_str(), program.c_str(), "stability", "--executor", "cpu", "--cases",
          folder_.path().c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  std::this_thread::sleep_for(std::chrono::seconds(2));
  kill(child, SIGINT);
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGINT);
  EXPECT_THAT(text_of(out), HasSubstr("interrupted, 6 trials not finished"));
}

}  // namespace
}  // namespace collidoscope

// Tests signals that end a program during a write. The program must end by the signal and leave no temporary
// file.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "sim_cuda/snapshot/snapshot.h"
#include "tests/run_program.h"

namespace collidoscope {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

/// For all tests: a script's background job ignores SIGINT and SIGQUIT, and one of nohup SIGHUP. Programs
/// that the tests start would inherit that.
class DefaultSignals : public testing::Environment {
  void SetUp() override {
    for (const int signal : {SIGINT, SIGQUIT, SIGHUP}) std::signal(signal, SIG_DFL);
  }
};
[[maybe_unused]] const auto* const default_signals = testing::AddGlobalTestEnvironment(new DefaultSignals);

/// Whether a temporary file whose name begins with `name` exists in the folder or its subfolders.
bool part_of(const fs::path& folder, const std::string& name) {
  std::error_code gone;
  for (auto at = fs::recursive_directory_iterator(folder, gone); at != fs::recursive_directory_iterator();
       at.increment(gone)) {
    const std::string file = at->path().filename().string();
    if (file.starts_with(name) && file.ends_with(".part")) return true;
    if (gone) return false;
  }
  return false;
}

/// Repeatedly starts the program and sends the signal during the write of the file `name`. Returns how often
/// the signal came in time.
int end_while_writing(const Arguments& arguments, const TemporaryFolder& folder, const std::string& name,
                      int signal, int times) {
  int hits = 0;
  for (int k = 0; k < times; ++k) {
    const pid_t child = fork();
    if (child == 0) become_program(headless_program(), arguments, {}, "/dev/null", "/dev/null");
    int status = 0;
    pid_t done = 0;
    while (done == 0 && !part_of(folder.path(), name)) {
      usleep(200);
      done = waitpid(child, &status, WNOHANG);
    }
    if (done == 0) {
      kill(child, signal);
      EXPECT_EQ(waitpid(child, &status, 0), child);
      EXPECT_TRUE((WIFSIGNALED(status) && WTERMSIG(status) == signal) ||
                  (WIFEXITED(status) && WEXITSTATUS(status) == 0))
          << status;
      hits += WIFSIGNALED(status) ? 1 : 0;
    }
    EXPECT_FALSE(part_of(folder.path(), "")) << "signal " << signal << ", run " << k;
  }
  return hits;
}

TEST(Signals, LeaveNoPictureHalfWritten) {
  const TemporaryFolder folder;
  const Arguments capture{"capture", "one_body",          "--states",  "0,1,2", "--size",        "1600x1000",
                          "--out",   folder / "pictures", "--quality", "quick", "--supersample", "1"};
  for (const int signal : {SIGINT, SIGTERM})
    EXPECT_EQ(end_while_writing(capture, folder, "one_body", signal, 1), 1);
}

TEST(Signals, LeaveNoFileOfARun) {
  const TemporaryFolder folder;
  const Arguments run{"run",           "box_collider", "--bodies",        "20000",      "--steps",    "0",
                      "--save",        folder / "s",   "--json",          folder / "j", "--executor", "cpu",
                      "--dump-bodies", folder / "b",   "--dump-dynamics", folder / "d"};
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT})
    EXPECT_GT(end_while_writing(run, folder, "", signal, 4), 0) << signal;
}

/// A signal ends a run early, and its files hold the completed steps.
TEST(Signals, KeepWhatARunHasComeTo) {
  const TemporaryFolder folder;
  const std::string saved = folder / "s", json = folder / "j", trace = folder / "t", err = folder / "err";
  for (const int signal : {SIGINT, SIGTERM}) {
    const pid_t child = fork();
    if (child == 0)
      become_program(headless_program(),
                     {"run", "box_collider", "--bodies", "3000", "--steps", "1000000", "--executor", "cpu",
                      "--save", saved, "--json", json, "--energy-trace", trace},
                     {}, "/dev/null", err);
    usleep(1'500'000);
    kill(child, signal);
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal) << status;
    const Snapshot snapshot = read_snapshot(saved);
    const std::int64_t steps = snapshot.state.steps;
    EXPECT_GT(steps, 0);
    EXPECT_THAT(text_of(err), testing::HasSubstr("interrupted at state " + std::to_string(steps) +
                                                 " of 1000000; the output files end at this state\n"));
    EXPECT_EQ(nlohmann::json::parse(text_of(json))["steps"], steps);
    const std::string rows = text_of(trace);
    EXPECT_EQ(std::ranges::count(rows, '\n'), steps + 2);
    const Outcome whole = run_headless({"run", "box_collider", "--bodies", "3000", "--steps",
                                        std::to_string(steps), "--executor", "cpu", "--json", "-"});
    EXPECT_EQ(nlohmann::json::parse(whole.out)["state_hash"],
              nlohmann::json::parse(text_of(json))["state_hash"]);
    fs::remove(err);
  }
}

/// The files of each row of a suite are committed before the next row is measured.
TEST(Signals, LeaveNoFileOfASuite) {
  const TemporaryFolder folder;
  const Arguments suite{"bench",      "broad-phases", "box_collider", "--sizes",    "10",
                        "--variants", "paper",        "--repeats",    "1",          "--csv",
                        folder / "c", "--json",       folder / "j",   "--markdown", folder / "m",
                        "--executor", "cpu"};
  EXPECT_GT(end_while_writing(suite, folder, "", SIGINT, 6), 0);
}

/// Long measurements stop at the first signal and write the results so far. A second signal ends them at
/// once.
TEST(Signals, LeaveNoFileOfAStudyThatIsInterruptedTwice) {
  const TemporaryFolder folder;
  const Arguments study{"accuracy", "box_collider", "--bodies",  "200", "--seconds",  "0.3",
                        "--json",   folder / "a",   "--repeats", "2",   "--executor", "cpu"};
  for (int k = 0; k < 2; ++k) {
    const pid_t child = fork();
    if (child == 0) become_program(headless_program(), study, {}, "/dev/null", "/dev/null");
    usleep(300'000);
    kill(child, SIGINT);
    int status = 0;
    pid_t done = 0;
    for (int tries = 0; done == 0 && tries < 20'000 && !part_of(folder.path(), ""); ++tries) {
      usleep(100);
      done = waitpid(child, &status, WNOHANG);
    }
    if (done == 0) {
      kill(child, SIGINT);
      ASSERT_EQ(waitpid(child, &status, 0), child);
    }
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGINT) << status;
    EXPECT_FALSE(part_of(folder.path(), ""));
  }
}

/// As under `nohup` or in a script's background job: signals that the parent ignores stay ignored.
TEST(Signals, ThatAreIgnoredStaySo) {
  const TemporaryFolder folder;
  const pid_t child = fork();
  if (child == 0) {
    for (const int signal : {SIGINT, SIGHUP}) std::signal(signal, SIG_IGN);
    become_program(headless_program(),
                   {"run", "box_collider", "--bodies", "2000", "--steps", "30", "--save", folder / "s"}, {},
                   "/dev/null", "/dev/null");
  }
  for (int k = 0; k < 10; ++k) {
    usleep(20'000);
    kill(child, SIGINT);
    kill(child, SIGHUP);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  EXPECT_TRUE(fs::exists(folder / "s"));
}

}  // namespace
}  // namespace collidoscope

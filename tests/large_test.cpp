// Tests scenes beyond the memory or the time of the machine: they are refused with figures, or end within a
// second of a signal.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/run_program.h"
#include "tests/viewer_fixture.h"

namespace collidoscope {
namespace {

using testing::MatchesRegex;
using Clock = std::chrono::steady_clock;

/// s. The program ends within one second; a busy machine may detect the end later. With a sanitizer, the end
/// of a work item and the release of memory take three times as long.
#ifdef WITH_SANITIZER
constexpr double soon = 6;
#else
constexpr double soon = 2;
#endif

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The headless program, started in a temporary folder, to be ended by a signal.
class Started {
 public:
  explicit Started(const std::vector<std::string>& arguments) : child_(fork()) {
    if (child_ != 0) return;
    if (chdir(folder_.path().c_str()) != 0) _exit(126);
    for (const int stream : {STDOUT_FILENO, STDERR_FILENO})
      if (dup2(open("/dev/null", O_WRONLY), stream) < 0) _exit(126);
    const std::string program = (program_folder() / "collidoscope-headless").string();
    std::vector<char*> argv{const_cast<char*>(program.c_str())};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    execv(program.c_str(), argv.data());
    _exit(127);
  }
  ~Started() {
    if (!ended_) kill(child_, SIGKILL), waitpid(child_, nullptr, 0);
  }
  Started(const Started&) = delete;
  Started& operator=(const Started&) = delete;

  bool running() {
    if (!ended_) ended_ = waitpid(child_, &status_, WNOHANG) == child_;
    return !ended_;
  }
  void send(int signal) const { kill(child_, signal); }
  /// Sends the signal; returns the seconds until the program ends.
  double end_by(int signal) {
    const Clock::time_point start = Clock::now();
    kill(child_, signal);
    while (running() && seconds_since(start) < 20) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    return seconds_since(start);
  }
  /// The exit status as a shell reports it.
  int status() const { return WIFSIGNALED(status_) ? 128 + WTERMSIG(status_) : WEXITSTATUS(status_); }
  const TemporaryFolder& folder() const { return folder_; }

 private:
  TemporaryFolder folder_;
  pid_t child_;
  bool ended_ = false;
  int status_ = 0;
};

const std::vector<std::string> large_run{"run",           "box_collider", "--bodies", "200000",
                                         "--allow-large", "--steps",      "1000"};

TEST(LargeRuns, EndWithinASecondOfASignal) {
  for (const int signal : {SIGINT, SIGTERM})
    for (const double wait : {0.02, 0.4, 1.1, 4.0}) {
      Started run(large_run);
      std::this_thread::sleep_for(std::chrono::duration<double>(wait));
      ASSERT_TRUE(run.running());
      EXPECT_LT(run.end_by(signal), soon) << "after " << wait << " s";
      EXPECT_EQ(run.status(), 128 + signal);
    }
}

/// After the first signal the program writes the completed steps, which may take longer.
TEST(LargeRuns, WithFilesEndWithinASecondOfASecondSignalAndLeaveNoFile) {
  std::vector<std::string> with_files = large_run;
  with_files.insert(with_files.end(), {"--json", "report", "--save", "end", "--dump-bodies", "bodies"});
  for (const double wait : {0.4, 4.0}) {
    Started run(with_files);
    std::this_thread::sleep_for(std::chrono::duration<double>(wait));
    ASSERT_TRUE(run.running());
    run.send(SIGTERM);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_LT(run.end_by(SIGTERM), soon) << "after " << wait << " s";
    EXPECT_EQ(run.status(), 128 + SIGTERM);
    EXPECT_EQ(run.folder().files(), 0u) << "after " << wait << " s";
  }
}

TEST(LargeRuns, FinishTheFilesThatTheyWriteWhenASignalComes) {
  for (const bool again : {false, true}) {
    Started run({"run", "box_collider", "--variant", "scaled", "--bodies", "300000", "--steps", "0",
                 "--dump-bodies", "bodies", "--dump-dynamics", "dynamics"});
    const auto is_writing = [&] {
      for (const auto& file : std::filesystem::directory_iterator(run.folder().path()))
        if (std::error_code gone; file.file_size(gone) > 1'000'000 && !gone) return true;
      return false;
    };
    while (!is_writing() && run.running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ASSERT_TRUE(run.running());
    if (again) run.send(SIGINT);
    if (again) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    run.end_by(SIGINT);
    EXPECT_EQ(run.status(), 128 + SIGINT);
    EXPECT_EQ(run.folder().files(), again ? 0u : 2u);
    if (again) continue;
    for (const char* name : {"bodies", "dynamics"}) {
      const std::string text = text_of(run.folder() / name);
      EXPECT_EQ(std::ranges::count(text, '\n'), 300'001) << name;
    }
  }
}

TEST(LargeRuns, OfCaptureEndWithinASecondOfASignal) {
  for (const double wait : {0.3, 2.5}) {
    Started capture({"capture", "box_collider", "--bodies", "200000", "--allow-large", "--states", "5",
                     "--executor", "cpu"});
    std::this_thread::sleep_for(std::chrono::duration<double>(wait));
    ASSERT_TRUE(capture.running());
    EXPECT_LT(capture.end_by(SIGINT), soon) << "after " << wait << " s";
    EXPECT_EQ(capture.status(), 128 + SIGINT);
    const std::filesystem::path pictures = capture.folder() / "captures";
    EXPECT_TRUE(!std::filesystem::exists(pictures) || std::filesystem::is_empty(pictures));
  }
}

TEST(LargeRuns, OfAccuracyEndWithinASecondOfASignal) {
  for (const double wait : {0.3, 3.0}) {
    Started study({"accuracy", "box_collider", "--bodies", "100000", "--executor", "cpu"});
    std::this_thread::sleep_for(std::chrono::duration<double>(wait));
    ASSERT_TRUE(study.running());
    EXPECT_LT(study.end_by(SIGINT), soon) << "after " << wait << " s";
    EXPECT_EQ(study.status(), 128 + SIGINT);
  }
}

TEST(LargeRuns, AreRefusedWithTheirFigures) {
  const Clock::time_point start = Clock::now();
  const Outcome run =
      run_headless({"run", "box_collider", "--bodies", "200000", "--memory-limit", "2000000000"});
  EXPECT_LT(seconds_since(start), 20) << "no step is begun";
  EXPECT_EQ(run.status, 3);
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(run.err,
              MatchesRegex("200,000 bodies have about [0-9,]+ initial pairs and [0-9,]+ initial contacts and "
                           "need about [0-9]+ bytes \\([0-9.]+ GB\\); available: 2000000000 bytes \\(2.0 "
                           "GB\\), the value of --memory-limit; use fewer bodies, --variant scaled, or a "
                           "higher --memory-limit\n"));
  const Outcome more = run_headless({"run", "box_collider", "--bodies", "100000000", "--variant", "scaled",
                                     "--memory-limit", "2000000000"});
  EXPECT_EQ(more.status, 3);
  EXPECT_EQ(more.err,
            "100,000,000 bodies need at least 10000000000 bytes (10.0 GB); available: 2000000000 bytes (2.0 "
            "GB), the value of --memory-limit; use fewer bodies, or a higher --memory-limit\n");
}

TEST(LargeRuns, WarnAboutTimeAndGoOn) {
  const Outcome warned = run_headless({"run", "box_collider", "--bodies", "80000", "--steps", "0",
                                       "--executor", "cpu", "--cpu-threads", "1"});
  EXPECT_EQ(warned.status, 0);
  EXPECT_THAT(warned.err,
              MatchesRegex("note: a step of 80,000 bodies with about [0-9,]+ pairs will take about "
                           "[0-9,]+ s on .*\n"));
  const Outcome quick =
      run_headless({"run", "box_collider", "--bodies", "2000", "--steps", "0", "--executor", "cpu"});
  EXPECT_EQ(quick.err, "");
}

using LargeWindow = Viewer;

TEST_F(LargeWindow, ShowsThatItPreparesAndCloses) {
  for (const char* way : {"button", "SIGTERM", "SIGINT"}) {
    SCOPED_TRACE(way);
    WindowDriver window({"box_collider", "--bodies", "200000", "--allow-large"}, {},
                        WindowDriver::Wait::for_window);
    const Clock::time_point start = Clock::now();
    while (window.colors_shown() < 3 && seconds_since(start) < 20)
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_GE(window.colors_shown(), 3u) << "nothing is shown";
    EXPECT_TRUE(window.frame().is_null()) << "it is still preparing";
    if (way == std::string("button"))
      window.press_close_button();
    else
      window.send_signal(way == std::string("SIGTERM") ? SIGTERM : SIGINT);
    int status = -1;
    const double seconds = window.seconds_to_end(status);
    EXPECT_GE(seconds, 0);
    EXPECT_LT(seconds, soon);
    EXPECT_EQ(status, 0) << window.errors();
  }
}

TEST_F(LargeWindow, AnswersWhileBodiesArePreparedAndKeepsTheRunIfCancelled) {
  WindowDriver window({"box_collider", "--bodies", "2000", "--variant", "scaled", "--executor", "cpu"});
  const auto prepares = [](const Json& f) {
    return f["last_notice"] == "preparing 6,000,000 bodies ...; Esc: cancel";
  };
  window.click("settings.bodies");
  window.hands({"key", "ctrl+a"});
  window.hands({"type", "6000000"});
  window.hands({"key", "Return"});
  window.move(640, 300);
  ASSERT_TRUE(window.wait_for(prepares)) << window.frame();
  window.key("F1");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["help"] == true; }));
  EXPECT_TRUE(prepares(window.frame())) << "the list of keys was opened meanwhile";
  window.key("F1");
  window.key("Escape");
  ASSERT_TRUE(window.wait_for([](const Json& f) {
    return f["last_notice"] == "cancelled: preparing 6,000,000 bodies";
  })) << window.frame();
  EXPECT_EQ(window.frame()["bodies"], 2000);
  const std::int64_t step = window.frame()["step"];
  ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["step"] > step; })) << "the run continues";
  window.key("space");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return !f["state_hash"].is_null(); }));
  EXPECT_EQ(window.frame()["state_hash"], expected_hash(window.frame()["step"], 2000, Variant::scaled));
  EXPECT_EQ(window.frame()["changes"], 0);
  EXPECT_TRUE(window.frame()["error"].is_null());
  EXPECT_EQ(close(window), "");
}

TEST_F(LargeWindow, ClosesWhileAStepIsMadeAndRemembersItsPanels) {
  WindowDriver window({"box_collider", "--bodies", "2000"});
  window.click("settings.bodies");
  window.hands({"key", "ctrl+a"});
  window.hands({"type", "100000"});
  window.hands({"key", "Return"});
  std::this_thread::sleep_for(std::chrono::seconds(3));  // bodies are prepared, or a step is made
  window.press_close_button();
  int status = -1;
  const double seconds = window.seconds_to_end(status);
  EXPECT_GE(seconds, 0);
  EXPECT_LT(seconds, soon);
  EXPECT_EQ(status, 0) << window.errors();
  EXPECT_TRUE(std::filesystem::exists(window.file("config/collidoscope")));
}

TEST_F(LargeWindow, KeepsTheRunThatItHasWhereNIsTooLarge) {
  WindowDriver window({"box_collider", "--bodies", "300", "--memory-limit", "1000000000"});
  window.type_into("settings.bodies", "150000");
  EXPECT_TRUE(window.wait_for(
      [&](const Json&) { return window.errors().find("150,000 bodies have about ") != std::string::npos; }));
  EXPECT_TRUE(window.wait_for([](const Json& f) { return f["bodies"] == 300; })) << window.frame();
  EXPECT_EQ(close(window), "");
}

}  // namespace
}  // namespace collidoscope

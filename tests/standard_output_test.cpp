// Tests results that cannot be written: a full disk, a closed stdout, a pipe without a reader, and a file
// size limit. The program must print one line, exit with a defined status and leave no partial file.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "sim_cuda/snapshot/snapshot.h"
#include "tests/run_program.h"
#include "tests/window_driver.h"
#include "viewer/render/image.h"

namespace collidoscope {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* full = "stdout: writing failed: No space left on device\n";

Arguments joined(Arguments arguments, const Arguments& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

/// Short runs of each command.
const Arguments run_one{"run", "one_body", "--steps", "3"};
const Arguments grade{"bvh", "box_collider", "--bodies", "10", "--methods", "lbvh_ropes", "--repeats", "1"};
const Arguments study{"accuracy", "box_collider", "--bodies", "2",          "--seconds",
                      "0.07",     "--repeats",    "1",        "--executor", "cpu"};
const Arguments analytic{"accuracy", "--integrator", "rk4", "--precision", "f64"};
const Arguments test_case{"stability", "attractor_head_on", "--solver", "soft_step", "--precision", "f32"};

Arguments suite(const std::string& name) {
  return {"bench",  name,        "box_collider", "--bodies",  "10", "--sizes",    "10,20", "--variants",
          "scaled", "--methods", "brute_force",  "--repeats", "1",  "--executor", "cpu"};
}

class EachCommand : public testing::TestWithParam<Arguments> {};

TEST_P(EachCommand, ReportsAFullDiskBehindStdout) {
  const Outcome outcome = run_headless(GetParam(), "/dev/full");
  EXPECT_EQ(outcome.status, 3);
  EXPECT_THAT(outcome.err, EndsWith(full));
}

TEST(Stdout, ThatIsClosedIsReported) {
  for (const Arguments& arguments : {Arguments{"--help"}, run_one, joined(run_one, {"--json", "-"}), grade,
                                     suite("broad-phases"), test_case}) {
    const Outcome outcome = run_headless(arguments, Launch{.close_stdout = true});
    EXPECT_EQ(outcome.status, 3) << arguments[0];
    EXPECT_THAT(outcome.err, EndsWith("stdout: writing failed: Bad file descriptor\n"));
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, EachCommand,
    testing::Values(Arguments{"--help"}, Arguments{"--version"}, Arguments{"run", "--help"},
                    Arguments{"capture", "--help"}, Arguments{"compare", "--help"},
                    Arguments{"bvh", "--help"}, Arguments{"bench", "--help"}, Arguments{"accuracy", "--help"},
                    Arguments{"stability", "--help"}, run_one, joined(run_one, {"--json", "-"}), grade,
                    joined(grade, {"--json", "-"}), study, analytic, test_case,
                    joined(test_case, {"--json", "-"}),
                    Arguments{"stability", "attractor_head_on", "--inject-faults"}, suite("broad-phases"),
                    joined(suite("broad-phases"), {"--json", "-"}),
                    Arguments{"bench", "scaling", "box_collider", "--sizes", "10,20", "--methods",
                              "brute_force", "--repeats", "1"},
                    Arguments{"bench", "predictors", "box_collider", "--sizes", "10,20,40,80", "--variants",
                              "scaled", "--methods", "lbvh_ropes,kd_tree", "--repeats", "1"},
                    Arguments{"bench", "effects", "box_collider", "--bodies", "10", "--repeats", "1"}));

TEST(Capture, ReportsAFullDiskBehindStdout) {
  const TemporaryFolder folder;
  const Arguments draw{"capture", "one_body", "--states", "0", "--size", "64x64", "--out", folder.path()};
  const Outcome outcome = run_headless(draw, "/dev/full");
  EXPECT_EQ(outcome.status, 3);
  EXPECT_THAT(outcome.err, EndsWith(full));
  EXPECT_EQ(folder.files(), 1u) << "the picture is written before its line";
  const std::string picture = folder / "one_body_0000.png";
  for (const Arguments& format : {Arguments{}, Arguments{"--json", "-"}}) {
    const Outcome compared = run_headless(joined({"compare", picture, picture}, format), "/dev/full");
    EXPECT_EQ(compared.status, 3);
    EXPECT_EQ(compared.err, full);
  }
}

TEST(ViewerOutput, ReportsAFullDiskBehindStdout) {
  for (const char* asked : {"--help", "--version"}) {
    const Outcome outcome = run_viewer({asked}, Launch{.stdout_to = "/dev/full"});
    EXPECT_EQ(outcome.status, 3) << asked;
    EXPECT_EQ(outcome.err, full);
    EXPECT_EQ(run_viewer({asked}, Launch{.close_stdout = true}).status, 3) << asked;
  }
}

TEST(Files, AreWholeWhateverBecomesOfStdout) {
  for (const Launch& launch : {Launch{.stdout_to = "/dev/full"}, Launch{.close_stdout = true}}) {
    const TemporaryFolder folder;
    const std::string file = folder / "s", json = folder / "j";
    EXPECT_EQ(run_headless(joined(run_one, {"--save", file, "--json", json}), launch).status, 3);
    EXPECT_EQ(read_snapshot(file).state.steps, 3);
    EXPECT_THAT(text_of(json), EndsWith("}\n"));
    EXPECT_EQ(folder.files(), 2u);
  }
}

TEST(Files, GetNothingOfAClosedStream) {
  const TemporaryFolder folder;
  const std::string json = folder / "j";
  // Without protection, the next opened file would get the closed stream's descriptor.
  const Outcome run =
      run_headless(joined(run_one, {"--json", json, "--changes", "/dev/null"}), Launch{.close_stderr = true});
  EXPECT_EQ(run.status, 2) << "an empty list of changes is none";
  EXPECT_FALSE(fs::exists(json));
  EXPECT_EQ(run_headless(joined(run_one, {"--json", json}), Launch{.close_stderr = true}).status, 0);
  EXPECT_THAT(text_of(json), testing::AllOf(StartsWith("{"), EndsWith("}\n")));
}

TEST(Pipe, ThatNothingReadsEndsTheProgramWithoutAWord) {
  for (const Arguments& arguments : {run_one, joined(run_one, {"--json", "-"}), grade}) {
    const Outcome outcome = run_headless(arguments, Launch{.break_pipe = true});
    EXPECT_EQ(outcome.status, 128 + SIGPIPE);
    EXPECT_EQ(outcome.err, "");
  }
  // At the moment of the failure the dynamics file is committed, the pipe breaks, and the snapshot is open.
  const TemporaryFolder folder;
  const Outcome outcome = run_headless(joined(run_one, {"--dump-dynamics", folder / "d", "--energy-trace",
                                                        "/dev/stdout", "--save", folder / "s"}),
                                       Launch{.break_pipe = true});
  EXPECT_EQ(outcome.status, 128 + SIGPIPE);
  EXPECT_EQ(outcome.err, "");
  EXPECT_EQ(folder.files(), 1u);
}

/// `@` in the arguments stands for the target.
struct Target {
  Arguments arguments;
  std::string flag;
};

Arguments aimed(Arguments arguments, const std::string& target) {
  for (std::string& argument : arguments)
    if (argument == "@") argument = target;
  return arguments;
}

std::vector<Target> file_targets() {
  std::vector<Target> targets;
  const auto add = [&](const Arguments& command, const Arguments& its_flags) {
    for (const std::string& flag : its_flags) targets.push_back({joined(command, {flag, "@"}), flag});
  };
  add(run_one, {"--json", "--dump-bodies", "--dump-dynamics", "--energy-trace", "--save"});
  add({"capture", "one_body", "--states", "0", "--out", "/tmp"}, {"--json"});
  add(grade, {"--json"});
  add(suite("broad-phases"), {"--json", "--csv", "--markdown", "--plot"});
  add({"bench", "frames", "one_body", "--frames", "1"}, {"--json"});
  add(study, {"--json", "--csv", "--markdown", "--plot"});
  add(analytic, {"--json", "--csv", "--markdown", "--plot"});
  add(test_case, {"--json"});
  add({"collidoscope"}, {"--automation"});
  return targets;
}

Outcome run_either(Arguments arguments, const Launch& launch) {
  if (arguments[0] != "collidoscope") return run_headless(arguments, launch);
  arguments.erase(arguments.begin());
  return run_viewer(arguments, launch);
}

void expect_refused(const Target& target, const std::string& at, const TemporaryFolder& folder) {
  const std::size_t files = folder.files();
  const Outcome outcome = run_either(aimed(target.arguments, at), Launch{.obey_permissions = true});
  EXPECT_EQ(outcome.status, 2) << target.arguments[0] << ' ' << target.flag << ' ' << at << ": "
                               << outcome.err;
  EXPECT_THAT(outcome.err, StartsWith(target.flag + ": " + at)) << target.arguments[0];
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(folder.files(), files);
}

TEST(OutputTarget, ThatCannotBeIsRefusedFirst) {
  const TemporaryFolder folder;
  const fs::path locked = folder / "locked";
  fs::create_directory(locked);
  std::ofstream(folder / "file") << "in the way";
  fs::permissions(locked, fs::perms::owner_read | fs::perms::owner_exec);
  const std::vector<std::string> places{folder / "none/x", folder / "file/x", folder.path(), "/proc/x",
                                        locked / "x"};
#ifdef WITH_SANITIZER  // a program takes a second to start: each target once, each place several times
  std::size_t next = 0;
  for (const Target& target : file_targets()) expect_refused(target, places[next++ % places.size()], folder);
#else
  for (const Target& target : file_targets())
    for (const std::string& at : places) expect_refused(target, at, folder);
#endif
  for (const Target& target : {Target{{"capture", "one_body", "--states", "0", "--out", "@"}, "--out"},
                               Target{joined(test_case, {"--save-failures", "@"}), "--save-failures"}})
    for (const std::string& at : {(folder / "file").string(), (folder / "file/x").string(),
                                  std::string("/proc/x"), (locked / "x").string()})
      expect_refused(target, at, folder);
  EXPECT_TRUE(fs::is_empty(locked));
}

TEST(OutputTarget, ThatIsFullIsReported) {
  for (const Target& target : file_targets()) {
    if (target.arguments[0] == "collidoscope") continue;  // needs a window: see below
    if (target.arguments[1] == "box_collider" && target.flag != "--json") continue;  // a study takes seconds
    const Outcome outcome = run_headless(aimed(target.arguments, "/dev/full"));
    EXPECT_EQ(outcome.status, 3) << target.arguments[0] << ' ' << target.flag << ": " << outcome.err;
    EXPECT_THAT(outcome.err, EndsWith("/dev/full cannot be written: No space left on device\n"));
  }
}

TEST(OutputTarget, BeyondTheLimitOfAFilesSizeStaysAsItWas) {
  const TemporaryFolder folder;
  std::ofstream(folder / "s") << "as it was";
  const Outcome run = run_headless(joined(run_one, {"--save", folder / "s"}), Launch{.max_file_bytes = 200});
  EXPECT_EQ(run.status, 3);
  EXPECT_EQ(run.err, "--save: " + (folder / "s").string() + " cannot be written: File too large\n");
  EXPECT_EQ(text_of(folder / "s"), "as it was");
  EXPECT_EQ(folder.files(), 1u);
  const fs::path pictures = folder / "pictures";
  const Outcome capture = run_headless({"capture", "one_body", "--states", "0", "--out", pictures},
                                       Launch{.max_file_bytes = 2000});
  EXPECT_EQ(capture.status, 3) << capture.err;
  EXPECT_THAT(capture.err, HasSubstr("one_body_0000.png cannot be written: File too large\n"));
  EXPECT_THAT(capture.err, testing::Not(HasSubstr("libpng")));
  EXPECT_TRUE(fs::is_empty(pictures));
}

/// Ends its process in the destructor.
class Process {
 public:
  Process(const fs::path& program, const Arguments& arguments, const Launch& launch, const std::string& out,
          const std::string& err)
      : id_(fork()) {
    if (id_ == 0) become_program(program, arguments, launch, out, err);
  }
  ~Process() {
    if (id_ > 0 && kill(id_, SIGKILL) == 0) wait();
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  int wait() {
    int status = 0;
    waitpid(id_, &status, 0);
    id_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

 private:
  pid_t id_;
};

TEST(Automation, OnAFullDiskEndsTheWindow) {
  if (const std::string reason = window_tests_unavailable_reason(); !reason.empty()) GTEST_SKIP() << reason;
  const TemporaryFolder folder;
  const std::string number = folder / "display";
  Process server("/usr/bin/Xvfb", {"-displayfd", "1", "-screen", "0", "800x600x24", "-nolisten", "tcp"},
                 Launch{}, number, folder / "xvfb.err");
  for (int tries = 0; tries < 400 && !text_of(number).ends_with('\n'); ++tries) usleep(25'000);
  std::string display = text_of(number);
  ASSERT_TRUE(display.ends_with('\n')) << "Xvfb did not start";
  display.pop_back();
  setenv("DISPLAY", (":" + display).c_str(), 1);
  setenv("XDG_CONFIG_HOME", (folder / "config").c_str(), 1);
  const std::string err = folder / "err";
  Process window(program_folder() / "collidoscope",
                 {"one_body", "--size", "640x480", "--automation", "/dev/full"}, Launch{.check_leaks = false},
                 folder / "out", err);
  EXPECT_EQ(window.wait(), 3);
  EXPECT_THAT(text_of(err), EndsWith("--automation: /dev/full cannot be written: No space left on device\n"));
  EXPECT_TRUE(fs::exists(folder / "config/collidoscope/settings.json")) << "what is remembered is written";
  unsetenv("DISPLAY");
}

}  // namespace
}  // namespace collidoscope

#include "sim_cuda/plugin/validation.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>

#include "sim_cuda/core/error.h"
#include "sim_cuda/plugin/library.h"
#include "sim_cuda/plugin/validation_child.h"

extern char** environ;

namespace collidoscope {
namespace {

constexpr int poll_interval = 100;  // ms
constexpr std::size_t longest_answer = 1 << 20;

/// A running child, and the pipe from it. Ends the child if it still runs.
class ValidationChild {
 public:
  ValidationChild(const std::string& path, const ValidationOptions& options) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) fail("create a pipe");
    pipe_ = ends[0];
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], answer_descriptor);
    posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
    std::string program = options.program, flag = child_flag, file = path, gpu = std::to_string(options.gpu);
    char* const arguments[] = {program.data(), flag.data(), file.data(), gpu.data(), nullptr};
    const int status = posix_spawn(&process_, program.c_str(), &actions, nullptr, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    if (status != 0) {
      close(pipe_);
      errno = status;
      fail("start a process");
    }
  }
  ~ValidationChild() {
    if (process_ > 0) end();
    close(pipe_);
  }
  ValidationChild(const ValidationChild&) = delete;
  ValidationChild& operator=(const ValidationChild&) = delete;

  /// Text that has arrived, after at most `poll_interval`. Unset at the end of the pipe.
  std::optional<std::string> read() {
    pollfd wait{pipe_, POLLIN, 0};
    if (poll(&wait, 1, poll_interval) <= 0) return "";
    char text[4096];
    const ssize_t length = ::read(pipe_, text, sizeof text);
    if (length < 0) return errno == EINTR ? std::optional<std::string>("") : std::nullopt;
    return length == 0 ? std::nullopt : std::optional(std::string(text, static_cast<std::size_t>(length)));
  }

  /// Waits for the end; returns how it ended if that was not a normal exit.
  std::string wait() {
    int status = 0;
    while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    process_ = 0;
    if (WIFSIGNALED(status)) return fmt::format("crashed with {}", strsignal(WTERMSIG(status)));
    return WEXITSTATUS(status) == 0 ? "" : fmt::format("ended with exit status {}", WEXITSTATUS(status));
  }
  void end() {
    kill(process_, SIGKILL);
    wait();
  }

 private:
  [[noreturn]] static void fail(const char* what) {
    throw MachineError(fmt::format("cannot {} to test a plug-in: {}", what, std::strerror(errno)));
  }

  pid_t process_ = 0;
  int pipe_ = -1;
};

/// Reads the lines of the child. See run_validation_child().
class AnswerReader {
 public:
  explicit AnswerReader(PluginValidation& validation) : validation_(validation) {}

  void take(const std::string& text) {
    rest_ += text;
    for (std::size_t end; (end = rest_.find('\n')) != std::string::npos; rest_.erase(0, end + 1))
      take_line(rest_.substr(0, end));
    if (rest_.size() > longest_answer) rest_.clear();
  }
  bool complete = false, in_test = false;
  std::string not_a_plugin;

 private:
  void take_line(const std::string& line) {
    const std::size_t space = line.find(' ');
    const std::string word = line.substr(0, space), value = space < line.size() ? line.substr(space + 1) : "";
    std::vector<PluginTest>& tests = validation_.tests;
    if (word == "name") validation_.name = value;
    if (word == "test") tests.push_back({value, 0, 0, {}}), in_test = true;
    if (word == "refused") not_a_plugin = value;
    if (word == "end") complete = true;
    if (tests.empty()) return;
    if (word == "boxes") tests.back().boxes = std::atoll(value.c_str());
    if (word == "pairs") tests.back().pairs = std::atoll(value.c_str()), in_test = false;
    if (word == "fault") tests.back().fault = value, in_test = false;
  }

  PluginValidation& validation_;
  std::string rest_;
};

}  // namespace

bool PluginValidation::passed() const { return ended.empty() && faults().empty(); }

std::vector<std::string> PluginValidation::faults() const {
  std::vector<std::string> lines;
  for (const PluginTest& test : tests)
    if (!test.fault.empty())
      lines.push_back(fmt::format("{}, {} boxes: {}", test.name, test.boxes, test.fault));
  return lines;
}

PluginValidation validate_plugin(const std::string& path, const ValidationOptions& options) {
  using Clock = std::chrono::steady_clock;
  PluginValidation validation;
  validation.path = path;
  validation.identity = file_identity(path);
  ValidationChild child(path, options);
  AnswerReader answers(validation);
  Clock::time_point last = Clock::now();
  const auto place = [&] {
    return answers.in_test            ? fmt::format(" in the test {}, {} boxes", validation.tests.back().name,
                                                    validation.tests.back().boxes)
           : validation.tests.empty() ? std::string(" while it was loaded")
                                      : std::string();
  };
  for (;;) {
    const std::optional<std::string> text = child.read();
    if (!text) break;
    if (!text->empty()) last = Clock::now();
    answers.take(*text);
    options.poll();
    if (std::chrono::duration<double>(Clock::now() - last).count() > options.timeout) {
      validation.ended = fmt::format("no answer for {} s{}", options.timeout, place());
      return validation;  // ends the child
    }
  }
  const std::string ended = child.wait();
  if (!answers.not_a_plugin.empty()) throw InputError(answers.not_a_plugin);
  if (!ended.empty())
    validation.ended = ended + place();
  else if (!answers.complete)
    validation.ended = "ended" + place();
  return validation;
}

}  // namespace collidoscope

#pragma once
// Runs a program as a user does and keeps its output. stdin is empty, and stdout and stderr are files, so the
// program sees no terminal.

#include <fcntl.h>
#include <linux/capability.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "sim_cuda/core/assets.h"
#include "tests/test_files.h"

namespace collidoscope {

struct Outcome {
  int status = -1;  ///< exit status; 128 + n if signal n ended the program
  std::string out, err;
};

inline std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline std::vector<std::string> text_lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Options of a program start.
struct Launch {
  std::string stdout_to = "";  ///< file for stdout instead of Outcome::out
  bool close_stdout = false;   ///< start without a stdout
  bool close_stderr = false;
  bool break_pipe = false;           ///< stdout is a pipe without a reader
  bool obey_permissions = false;     ///< also for root: files without permissions cannot be opened
  std::int64_t max_file_bytes = -1;  ///< larger writes fail; -1: no limit
  int interrupt_after_ms = 0;        ///< send SIGINT after this time; 0: never
  /// Leak check of the address sanitizer. Must be off for windows: the software renderer leaks a few bytes at
  /// exit, which would change the exit status.
  bool check_leaks = true;
};

/// Replaces this process by the program, or calls _exit(126) or _exit(127). Call it in a child process.
[[noreturn]] inline void become_program(const std::filesystem::path& program,
                                        const std::vector<std::string>& arguments, const Launch& launch,
                                        const std::string& out, const std::string& err) {
  const auto redirect = [](const char* file, int flags, int to) {
    const int from = open(file, flags, 0600);
    if (from < 0 || dup2(from, to) < 0) _exit(126);
    close(from);
  };
  redirect("/dev/null", O_RDONLY, STDIN_FILENO);
  redirect(out.c_str(), O_WRONLY | O_CREAT, STDOUT_FILENO);
  redirect(err.c_str(), O_WRONLY | O_CREAT, STDERR_FILENO);
  if (int ends[2]; launch.break_pipe) {
    if (pipe(ends) != 0 || dup2(ends[1], STDOUT_FILENO) < 0) _exit(126);
    close(ends[0]);
    close(ends[1]);
  }
  if (launch.close_stdout) close(STDOUT_FILENO);
  if (launch.close_stderr) close(STDERR_FILENO);
  if (launch.obey_permissions && geteuid() == 0)
    for (const unsigned long right : {CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH})
      if (prctl(PR_CAPBSET_DROP, right, 0, 0, 0) != 0)
        _exit(126);  // capabilities after exec are limited to this set
  if (launch.max_file_bytes >= 0) {
    const auto bytes = static_cast<rlim_t>(launch.max_file_bytes);
    const rlimit limit{bytes, bytes};
    if (setrlimit(RLIMIT_FSIZE, &limit) != 0) _exit(126);
  }
  if (!launch.check_leaks) {
    const char* options = std::getenv("ASAN_OPTIONS");
    setenv("ASAN_OPTIONS", (std::string(options ? options : "") + ":detect_leaks=0").c_str(), 1);
  }
  alarm(300);  // s; SIGALRM ends a program that hangs
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  execv(program.c_str(), argv.data());
  _exit(127);
}

inline Outcome run_program(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                           const Launch& launch) {
  const TemporaryFolder folder;
  const std::string out = launch.stdout_to.empty() ? (folder / "out").string() : launch.stdout_to;
  const std::string err = folder / "err";
  const pid_t child = fork();
  if (child == 0) become_program(program, arguments, launch, out, err);
  if (child > 0 && launch.interrupt_after_ms > 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(launch.interrupt_after_ms));
    kill(child, SIGINT);
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child) return {};
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
          launch.stdout_to.empty() ? text_of(out) : "", text_of(err)};
}
inline Outcome run_program(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                           const std::string& stdout_to = "") {
  return run_program(program, arguments, Launch{.stdout_to = stdout_to});
}

inline std::filesystem::path headless_program() { return program_folder() / "collidoscope-headless"; }
inline Outcome run_headless(const std::vector<std::string>& arguments, const Launch& launch) {
  return run_program(headless_program(), arguments, launch);
}
inline Outcome run_headless(const std::vector<std::string>& arguments, const std::string& stdout_to = "") {
  return run_program(headless_program(), arguments, stdout_to);
}
/// Runs the program with a window, without a display.
inline Outcome run_viewer(const std::vector<std::string>& arguments, const Launch& launch = {}) {
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  return run_program(program_folder() / "collidoscope", arguments, launch);
}

}  // namespace collidoscope

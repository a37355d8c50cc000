#pragma once
// Runs a program as a user would and keeps what it printed. Its stdin is empty and its stdout and stderr are
// files, so it sees no terminal.

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "sim_cuda/core/assets.h"
#include "tests/test_files.h"

namespace collidoscope {

struct Outcome {
  int status = -1;  ///< exit status; 128 + n where signal n ended it, as shells count
  std::string out, err;
};

inline std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// `stdout_to`: a file that takes the program's stdout in place of Outcome::out.
inline Outcome run_program(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                           const std::string& stdout_to = "") {
  const TemporaryFolder folder;
  const std::string out = stdout_to.empty() ? folder / "out" : std::filesystem::path(stdout_to);
  const std::string err = folder / "err";
  const pid_t child = fork();
  if (child == 0) {
    const auto redirect = [](const char* file, int flags, int to) {
      const int from = open(file, flags, 0600);
      if (from < 0 || dup2(from, to) < 0) _exit(126);
      close(from);
    };
    redirect("/dev/null", O_RDONLY, STDIN_FILENO);
    redirect(out.c_str(), O_WRONLY | O_CREAT, STDOUT_FILENO);
    redirect(err.c_str(), O_WRONLY | O_CREAT, STDERR_FILENO);
    std::vector<char*> argv{const_cast<char*>(program.c_str())};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    execv(program.c_str(), argv.data());
    _exit(127);
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child) return {};
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
          stdout_to.empty() ? text_of(out) : "", text_of(err)};
}

inline Outcome run_headless(const std::vector<std::string>& arguments, const std::string& stdout_to = "") {
  return run_program(program_folder() / "collidoscope-headless", arguments, stdout_to);
}

}  // namespace collidoscope

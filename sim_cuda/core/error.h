#pragma once
// Exceptions for errors of a run: InputError and MachineError. The code throws no other exceptions to report
// errors. what() is one or more complete lines, ready for stderr.

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace collidoscope {

/// Invalid input: a file, a flag, a value. One line per error: `file:line:column: problem and allowed
/// values`. The programs print the first 20 lines and exit with status 2.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::string line) : InputError(std::vector<std::string>{std::move(line)}) {}
  /// `lines` has at least one element; no line ends in a newline.
  explicit InputError(std::vector<std::string> lines)
      : std::runtime_error(join(lines)), lines_(std::move(lines)) {}
  const std::vector<std::string>& lines() const { return lines_; }

 private:
  static std::string join(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += (text.empty() ? "" : "\n") + line;
    return text;
  }
  std::vector<std::string> lines_;
};

/// Missing hardware, memory, display or file access. The line states the request and the answer of the
/// system. The programs exit with status 3.
class MachineError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A run needs more memory than it may use.
class TooLarge : public MachineError {
 public:
  /// `plain`: the same message without command-line flags.
  TooLarge(const std::string& line, std::string plain) : MachineError(line), plain_(std::move(plain)) {}
  const std::string& plain() const { return plain_; }

 private:
  std::string plain_;
};

}  // namespace collidoscope

#pragma once
// The two ways in which a run can be refused. Nothing else is thrown on purpose; what() is one or more
// complete lines, ready for stderr.

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace collidoscope {

/// What the user gave is wrong: a file, a flag, a value. One line per fault, each
/// `file:line:column: what, and what would be right`. The programs print the first 20 and exit with status 2.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::string line) : InputError(std::vector<std::string>{std::move(line)}) {}
  /// `lines` holds at least one fault; no line ends in a newline.
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

/// The machine lacks something: a GPU, memory, a display. The line says what was asked of
/// it and what it answered. The programs exit with status 3.
class MachineError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a run asks for is more memory than it may have.
class TooLarge : public MachineError {
 public:
  /// `plain` says the same without flags of the command line.
  TooLarge(const std::string& line, std::string plain) : MachineError(line), plain_(std::move(plain)) {}
  const std::string& plain() const { return plain_; }

 private:
  std::string plain_;
};

}  // namespace collidoscope

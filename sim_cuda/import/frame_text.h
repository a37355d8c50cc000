#pragma once
// Text files with frames one after the other, each with a number of rows in its header: XYZ and LAMMPS dumps.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim_cuda/import/table_file.h"

namespace collidoscope {

/// Position in a text file. Lives for one reading; the text is the caller's.
class LineReader {
 public:
  LineReader(const std::string& file, std::string_view text) : file_(file), rest_(text) {}

  bool at_end() const { return rest_.empty(); }
  std::size_t line() const { return line_; }  ///< number of the next line, from 1
  std::string_view rest() const { return rest_; }
  /// Throws InputError at the end of the file. `expected` completes "expected".
  std::string_view next(const char* expected);
  /// Skips empty lines.
  void skip_empty();
  /// Removes `count` lines and returns their text; at the end of the file, those that there are.
  std::string_view take(std::size_t count, std::size_t& taken);
  /// Reads the only word of the last line as a whole number of at most `most`.
  std::size_t whole(std::string_view text, std::size_t most, const char* what) const;
  [[noreturn]] void fail_at_end(std::size_t taken, std::size_t count) const;
  /// A fault in the last line.
  [[noreturn]] void fail(const std::string& problem, const std::string& expected) const;

 private:
  std::string file_;
  std::string_view rest_;
  std::size_t line_ = 1;
};

/// The rows of one frame.
struct FrameRows {
  std::vector<std::string> names;  ///< of columns
  std::size_t count = 0, first_line = 1;
  std::string_view rows;
};

/// Throws InputError.
[[noreturn]] void refuse_frame(const std::string& file, std::int64_t wanted, std::int64_t frames);

/// Finds the frames from `first` on, at most `most`. `read_header` reads the lines before the rows of a
/// frame. `notes.frames` becomes the number of frames in the file; an incomplete last frame is not counted,
/// and a note is added. Throws InputError.
template <class Frame>
std::vector<Frame> find_frames(const std::string& file, std::string_view text, std::int64_t first,
                               std::int64_t most, Frame (*read_header)(LineReader&), BodyTable& notes) {
  LineReader lines(file, text);
  std::vector<Frame> found;
  notes.frames = 0;
  for (lines.skip_empty(); !lines.at_end(); lines.skip_empty()) {
    Frame frame = read_header(lines);
    frame.first_line = lines.line();
    std::size_t taken = 0;
    frame.rows = lines.take(frame.count, taken);
    if (taken < frame.count) {
      if (notes.frames <= first) lines.fail_at_end(taken, frame.count);
      notes.notes.emplace_back("the last frame is incomplete");
      break;
    }
    const std::int64_t number = notes.frames++;
    if (number >= first && number - first < most) found.push_back(std::move(frame));
  }
  if (found.empty()) refuse_frame(file, first, notes.frames);
  return found;
}

/// Reads the rows of a frame. `notes`: frames and notes of find_frame().
BodyTable read_frame(const std::string& file, const FrameRows& frame, const TableOptions& options,
                     BodyTable notes);

}  // namespace collidoscope

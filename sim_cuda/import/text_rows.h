#pragma once
// Reads rows of numbers from text with several threads. Lives for one reading; the text is the caller's.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "sim_cuda/import/body_table.h"

namespace collidoscope {

/// The next line of `text` without its end, which is removed from `text`.
std::string_view take_line(std::string_view& text);
/// `text` without spaces and tabs at its ends.
std::string_view trimmed(std::string_view text);
/// The fields of a line, without spaces at their ends and without quotes. `separator` ' ': spaces and tabs.
std::vector<std::string_view> fields_of(std::string_view line, char separator);
/// A finite number, or infinity, or nan. Returns whether the whole field is one.
bool is_number(std::string_view field, double& number);

/// Text of a file as it may stand in a line of output: without control characters, at most 40 bytes; '' if
/// empty.
std::string shown_text(std::string_view text);

class TextRows {
 public:
  /// `text`: the rows alone. Lines without fields are skipped, and with `comments` those that begin with #.
  /// `first_line`: number of its first line in the file.
  TextRows(std::string file, std::string_view text, std::size_t first_line, char separator, bool comments);

  std::size_t rows() const { return rows_; }
  /// Reads all rows, a number for each target that is used. Each row must have as many fields as there are
  /// targets. Throws InputError with a line `file:line:column: problem` for each fault, at most 20.
  void read(const std::vector<ColumnTarget>& targets) const;

 private:
  struct Part {
    std::string_view text;
    std::size_t lines = 0, rows = 0, first_line = 0, first_row = 0;
  };
  bool is_row(std::string_view line) const;
  void count(Part& part) const;
  void read(const Part& part, const std::vector<ColumnTarget>& targets,
            std::vector<std::string>& faults) const;
  bool read_row(std::string_view line, std::size_t row, const std::vector<ColumnTarget>& targets,
                std::size_t& column, std::string& fault) const;

  std::string file_;
  char separator_;
  bool comments_;
  std::vector<Part> parts_;
  std::size_t rows_ = 0;
};

}  // namespace collidoscope

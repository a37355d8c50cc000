#pragma once
// Tables in Markdown, and texts of the code tables as their cells.

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace collidoscope {

class MarkdownTable {
 public:
  explicit MarkdownTable(std::initializer_list<std::string_view> columns);
  explicit MarkdownTable(std::span<const std::string> columns);
  /// As many cells as columns, in Markdown.
  void row(const std::vector<std::string>& cells);
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// The text between backticks.
std::string code(std::string_view text);
/// "`a`, `b` or `c`".
std::string code_list(const std::vector<std::string_view>& names, std::string_view last = " or ");

/// A phrase of a code table as Markdown. Outside backticks it puts names with '_', flags, quoted words, auto
/// and the solver in "with impulse" into backticks, and writes "^2" as ², '*' as ·.
std::string prose(std::string_view text);

/// The shortest decimal number; large powers of 10 and 2 as powers, such as 10⁻⁹.
std::string number_text(double value);
/// "m/s²" of "m/s^2".
std::string unit_text(std::string_view unit);

}  // namespace collidoscope

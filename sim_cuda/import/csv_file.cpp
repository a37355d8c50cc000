#include <fmt/format.h>

#include <algorithm>

#include "sim_cuda/core/error.h"
#include "sim_cuda/import/input_file.h"
#include "sim_cuda/import/table_file.h"
#include "sim_cuda/import/text_rows.h"

namespace collidoscope {
namespace {

constexpr std::size_t most_columns = 4096;

char separator_of(std::string_view line) {
  for (const char separator : {';', ',', '\t'})
    if (line.find(separator) != std::string_view::npos) return separator;
  return ' ';
}

bool all_numbers(const std::vector<std::string_view>& fields) {
  double number = 0;
  return std::ranges::all_of(fields, [&](std::string_view field) { return is_number(field, number); });
}

std::vector<std::string> names_in_line(const std::vector<std::string_view>& fields) {
  return {fields.begin(), fields.end()};
}

/// The names of the columns, and what follows the line with them.
struct CsvStart {
  std::vector<std::string> names;
  std::size_t columns = 0, first_line = 1;
  char separator = ',';
  std::string_view rows;
};

CsvStart csv_start(std::string_view text, const std::string& file) {
  CsvStart start;
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // byte-order mark
  std::string_view comment;
  while (true) {
    start.rows = text;
    if (text.empty()) throw InputError(file + ": no rows, expected a row of numbers for each body");
    const std::string_view line = take_line(text);
    if (trimmed(line).starts_with('#')) comment = trimmed(trimmed(line).substr(1));
    if (!trimmed(line).empty() && !trimmed(line).starts_with('#')) {
      start.separator = separator_of(line);
      const std::vector<std::string_view> fields = fields_of(line, start.separator);
      start.columns = fields.size();
      if (start.columns > most_columns)
        throw InputError(fmt::format("{}:{}:1: {} columns, expected at most {}", file, start.first_line,
                                     start.columns, most_columns));
      if (!all_numbers(fields)) {
        start.names = names_in_line(fields);
        start.rows = text;
        ++start.first_line;
      } else if (!comment.empty()) {  // numpy.savetxt(..., header="x y z")
        const std::vector<std::string_view> names = fields_of(comment, separator_of(comment));
        if (names.size() == start.columns && !all_numbers(names)) start.names = names_in_line(names);
      }
      return start;
    }
    ++start.first_line;
  }
}

}  // namespace

BodyTable read_csv_bodies(const std::string& name, const TableOptions& options) {
  const InputFile file(name, "a table of bodies");
  const FileText contents(file);
  const CsvStart start = csv_start(contents.text(), name);
  if (options.preview != nullptr) {
    preview_text(*options.preview, start.names, start.columns, start.rows, start.separator, true);
    return {};
  }
  const ColumnChoice choice = choose_columns(options.columns, start.names, start.columns, name);
  const TextRows rows(name, start.rows, start.first_line, start.separator, true);
  BodyTableBuilder table(choice, rows.rows(), options.scale, name);
  rows.read(table.targets(start.columns));
  return table.finish(start.names, start.columns);
}

}  // namespace collidoscope

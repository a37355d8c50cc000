#include "sim_cuda/import/text_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>

#include "sim_cuda/core/error.h"
#include "sim_cuda/import/input_file.h"

namespace collidoscope {
namespace {

constexpr std::size_t most_row_faults = 20;
constexpr std::size_t bytes_of_part = std::size_t{1} << 20;

bool is_blank(char c) { return c == ' ' || c == '\t'; }

const char* after_blanks(const char* at, const char* end) {
  while (at < end && is_blank(*at)) ++at;
  return at;
}

/// The end of the field that begins at `at`.
const char* end_of_field(const char* at, const char* end, char separator) {
  if (at < end && *at == '"') {
    const void* const quote = std::memchr(at + 1, '"', static_cast<std::size_t>(end - at - 1));
    if (quote != nullptr) at = static_cast<const char*>(quote) + 1;
  }
  if (separator == ' ')
    while (at < end && !is_blank(*at)) ++at;
  else
    while (at < end && *at != separator) ++at;
  return at;
}

}  // namespace

std::string_view take_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> fields_of(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  if (trimmed(line).empty()) return fields;
  if (separator != '\t') line = trimmed(line);
  const char *at = line.data(), *const end = at + line.size();
  while (true) {
    if (separator != '\t') at = after_blanks(at, end);
    const char* const stop = end_of_field(at, end, separator);
    std::string_view field = trimmed({at, static_cast<std::size_t>(stop - at)});
    if (field.size() >= 2 && field.front() == '"' && field.back() == '"')
      field = field.substr(1, field.size() - 2);
    fields.push_back(field);
    if (stop == end) return fields;
    at = stop + 1;
  }
}

bool is_number(std::string_view field, double& number) {
  if (field.starts_with('+')) field.remove_prefix(1);
  const char* const end = field.data() + field.size();
  const auto [stop, error] = std::from_chars(field.data(), end, number);
  return error == std::errc{} && stop == end && !field.empty();
}

std::string shown_text(std::string_view text) {
  std::string shown(text.substr(0, 40));
  for (char& c : shown)
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7f) c = '?';
  return shown.empty() ? "''" : shown;
}

TextRows::TextRows(std::string file, std::string_view text, std::size_t first_line, char separator,
                   bool comments)
    : file_(std::move(file)), separator_(separator), comments_(comments) {
  while (!text.empty()) {
    const std::size_t end = text.size() <= bytes_of_part
                                ? text.size()
                                : std::min(text.find('\n', bytes_of_part), text.size() - 1) + 1;
    parts_.push_back({text.substr(0, end)});
    text.remove_prefix(end);
  }
  on_all_cores(parts_.size(), 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) count(parts_[k]);
  });
  for (Part& part : parts_) {
    part.first_line = first_line;
    part.first_row = rows_;
    first_line += part.lines;
    rows_ += part.rows;
  }
}

bool TextRows::is_row(std::string_view line) const {
  const char* const at = after_blanks(line.data(), line.data() + line.size());
  return at != line.data() + line.size() && !(comments_ && *at == '#');
}

void TextRows::count(Part& part) const {
  for (std::string_view rest = part.text; !rest.empty();) {
    part.rows += is_row(take_line(rest)) ? 1 : 0;
    ++part.lines;
  }
}

void TextRows::read(const std::vector<ColumnTarget>& targets) const {
  std::vector<std::vector<std::string>> faults(parts_.size());
  on_all_cores(parts_.size(), 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) read(parts_[k], targets, faults[k]);
  });
  std::vector<std::string> all;
  for (const std::vector<std::string>& some : faults)
    for (const std::string& fault : some)
      if (all.size() < most_row_faults) all.push_back(fault);
  if (!all.empty()) throw InputError(all);
}

void TextRows::read(const Part& part, const std::vector<ColumnTarget>& targets,
                    std::vector<std::string>& faults) const {
  std::size_t row = part.first_row, number = part.first_line;
  for (std::string_view rest = part.text; !rest.empty(); ++number) {
    const std::string_view line = take_line(rest);
    if (!is_row(line)) continue;
    std::size_t column = 0;
    std::string fault;
    if (read_row(line, row++, targets, column, fault)) continue;
    faults.push_back(fmt::format("{}:{}:{}: {}", file_, number, column + 1, fault));
    if (faults.size() == most_row_faults) return;
  }
}

/// On a fault returns false, and sets its column, from 0, and its message.
bool TextRows::read_row(std::string_view line, std::size_t row, const std::vector<ColumnTarget>& targets,
                        std::size_t& column, std::string& fault) const {
  const char* const begin = line.data();
  const char* end = begin + line.size();
  while (end > begin && is_blank(end[-1]) && separator_ != '\t') --end;
  const char* at = begin;
  const auto refuse = [&](const char* where, std::string what) {
    column = static_cast<std::size_t>(where - begin);
    fault = std::move(what);
    return false;
  };
  for (std::size_t k = 0; k < targets.size(); ++k) {
    if (separator_ != '\t') at = after_blanks(at, end);
    if (at == end && separator_ == ' ')
      return refuse(at, fmt::format("{} columns, expected {}", k, targets.size()));
    const char* const stop = end_of_field(at, end, separator_);
    if (const ColumnTarget& target = targets[k]; target.first != nullptr) {
      std::string_view field = trimmed({at, static_cast<std::size_t>(stop - at)});
      if (field.size() >= 2 && field.front() == '"' && field.back() == '"')
        field = field.substr(1, field.size() - 2);
      double number = 0;
      if (!is_number(field, number))
        return refuse(at, fmt::format("{} is not a number, expected {}", shown_text(field),
                                      info_of(target.quantity).name));
      if (!target.store(row, number)) return refuse(at, range_fault(target, shown_text(field)));
    }
    const bool is_last = k + 1 == targets.size();
    if (!is_last && stop == end && separator_ != ' ')
      return refuse(stop, fmt::format("{} columns, expected {}", k + 1, targets.size()));
    at = stop == end ? end : is_last || separator_ == ' ' ? stop : stop + 1;
  }
  at = after_blanks(at, end);
  if (at != end) return refuse(at, fmt::format("more than {} columns", targets.size()));
  return true;
}

}  // namespace collidoscope

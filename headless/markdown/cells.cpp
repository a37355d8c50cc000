#include "headless/markdown/cells.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <cmath>

namespace collidoscope {
namespace {

std::string superscript(int exponent) {
  constexpr std::array<std::string_view, 10> digits{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = exponent < 0 ? "⁻" : "";
  for (const char digit : fmt::to_string(std::abs(exponent)))
    text += digits[static_cast<std::size_t>(digit - '0')];
  return text;
}

bool is_word_character(char character) {
  return std::isalnum(static_cast<unsigned char>(character)) || character == '_' || character == '-';
}

/// A name of a file or of the command line, and no word of the language. `before`: the text before it.
bool is_code_word(std::string_view word, std::string_view before) {
  return word.find('_') != word.npos || word.starts_with("--") || word == "auto" ||
         (word == "impulse" && before.ends_with("with "));
}

/// A cell has no bar of its own.
std::string with_bars_escaped(std::string_view text) {
  std::string escaped;
  for (const char character : text) {
    if (character == '|') escaped += '\\';
    escaped += character;
  }
  return escaped;
}

}  // namespace

MarkdownTable::MarkdownTable(std::initializer_list<std::string_view> columns)
    : MarkdownTable(std::vector<std::string>(columns.begin(), columns.end())) {}

MarkdownTable::MarkdownTable(std::span<const std::string> columns) {
  row({columns.begin(), columns.end()});
  for (std::size_t k = 0; k < columns.size(); ++k) text_ += "|---";
  text_ += "|\n";
}

void MarkdownTable::row(const std::vector<std::string>& cells) {
  text_ += '|';
  for (const std::string& cell : cells) text_ += cell.empty() ? " |" : " " + with_bars_escaped(cell) + " |";
  text_ += '\n';
}

std::string code(std::string_view text) { return fmt::format("`{}`", text); }

std::string code_list(const std::vector<std::string_view>& names, std::string_view last) {
  std::string text;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (k > 0) text += k + 1 == names.size() ? last : ", ";
    text += code(names[k]);
  }
  return text;
}

std::string prose(std::string_view text) {
  std::string result;
  bool in_code = false;
  for (std::size_t at = 0; at < text.size();) {
    const std::string_view rest = text.substr(at);
    std::size_t length = 1;
    if (in_code || rest[0] == '`') {
      in_code = in_code != (rest[0] == '`');
      result += rest[0];
    } else if (rest[0] == '"') {
      length = rest.find('"', 1) + 1;
      result += code(rest.substr(0, length));
    } else if (rest[0] == '^' && rest.size() > 1 && std::isdigit(static_cast<unsigned char>(rest[1]))) {
      for (; length < rest.size() && std::isdigit(static_cast<unsigned char>(rest[length])); ++length) {
      }
      result += superscript(std::stoi(std::string(rest.substr(1, length - 1))));
    } else if (rest[0] == '*') {
      result += "·";
    } else if (is_word_character(rest[0])) {
      for (; length < rest.size() && is_word_character(rest[length]); ++length) {
      }
      const std::string_view word = rest.substr(0, length);
      result += is_code_word(word, text.substr(0, at)) ? code(word) : std::string(word);
    } else {
      result += rest[0];
    }
    at += length;
  }
  return result;
}

std::string number_text(double value) {
  if (value < 0) return "−" + number_text(-value);
  const std::string text = fmt::format("{:.15g}", value);
  if (text.starts_with("1e")) return "10" + superscript(std::stoi(text.substr(2)));
  if (text.size() > 5 && text.find_first_not_of('0', 1) == text.npos && text[0] == '1')
    return "10" + superscript(static_cast<int>(text.size()) - 1);
  int exponent = 0;
  constexpr int first_power_of_two = 20;
  if (std::frexp(value, &exponent) == 0.5 && exponent > first_power_of_two)
    return "2" + superscript(exponent - 1);
  return text;
}

std::string unit_text(std::string_view unit) { return prose(unit); }

}  // namespace collidoscope

#include "sim_cuda/scene/json_syntax.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include "sim_cuda/scene/names.h"

namespace collidoscope {
namespace {

std::string line_of(std::string_view text, std::uint32_t offset) {
  return fmt::format("line {}", 1 + std::count(text.begin(), text.begin() + offset, '\n'));
}

int hex_value(std::string_view digits) {
  int value = -1;
  if (digits.size() < 4) return -1;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + 4, value, 16);
  return error == std::errc{} && end == digits.data() + 4 ? value : -1;
}

/// Explains the error in the string that starts at `at`.
JsonFault explain_text(std::string_view text, std::uint32_t at) {
  const std::string_view escapes = "\"\\/bfnrt";
  for (std::uint32_t i = at + 1; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c == '"') {
      std::size_t bad = 0;
      if (!is_utf8(text.substr(at, i - at), &bad)) {
        return {static_cast<std::uint32_t>(at + bad), "this byte is not UTF-8; save the file as UTF-8"};
      }
      break;
    }
    if (c == '\n' || c == '\r') {
      return {at,
              "this string has no closing quote on its line; end it with \", and write a line break as \\n"};
    }
    if (c < 0x20) {
      return {i, fmt::format("a control character (byte {0}) in a string; write it as \\u{0:04x}", int{c})};
    }
    if (c != '\\') continue;
    const std::string_view rest = text.substr(i + 1);
    if (rest.empty()) break;
    if (rest[0] == 'u') {
      const int code = hex_value(rest.substr(1));
      if (code < 0) return {i, "\\u needs four hexadecimal digits, such as \\u00e9"};
      const bool high = code >= 0xD800 && code < 0xDC00, low = code >= 0xDC00 && code < 0xE000;
      const bool paired = high && rest.substr(5, 2) == "\\u" && hex_value(rest.substr(7)) >= 0xDC00 &&
                          hex_value(rest.substr(7)) < 0xE000;
      if (low || (high && !paired)) {
        return {i, "half of a surrogate pair; write both halves, or the character itself"};
      }
      i += paired ? 11 : 5;
    } else if (escapes.find(rest[0]) == std::string_view::npos) {
      return {i,
              "unknown escape sequence; known are \\\" \\\\ \\/ \\b \\f \\n \\r \\t and \\uXXXX (write \\\\ "
              "for \\)"};
    } else {
      ++i;
    }
  }
  return {at, "this string has no closing quote; end it with \""};
}

bool is_word_part(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '+' || c == '-' || c == '.' ||
         (static_cast<unsigned char>(c) & 0x80) != 0;
}

/// The run of letters, digits and signs at `at`; at least one character.
std::string_view word_at(std::string_view text, std::uint32_t at) {
  std::uint32_t end = at;
  while (end < text.size() && is_word_part(text[end])) ++end;
  return text.substr(at, std::max<std::uint32_t>(end - at, 1));
}

/// Explains a number that is out of a double's range or not in JSON syntax.
std::string explain_number(std::string_view word) {
  double value = 0;
  const std::string_view digits = word.substr(word.starts_with('-') ? 1 : 0);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (end == digits.data() + digits.size() && error == std::errc::result_out_of_range) {
    return fmt::format("{} is out of range of a double; the maximum is 1.8e308", printable(word));
  }
  return fmt::format(
      "\"{}\" is not a JSON number; write digits, then .digits, then e and an "
      "exponent, such as 0.5 or 1e-3 (no leading + or zeros, no bare point)",
      printable(word));
}

bool is_non_finite(std::string_view word) {
  std::string lower(word.substr(word.starts_with('-') || word.starts_with('+') ? 1 : 0));
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower == "nan" || lower == "inf" || lower == "infinity";
}

bool begins_number(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '+' || c == '.';
}

bool is_value(const std::string& word) {
  if (word == "true" || word == "false" || word == "null") return true;
  const std::size_t first = word.starts_with('-') ? 1 : 0;
  const auto digit_at = [&](std::size_t at) {
    return at < word.size() && std::isdigit(static_cast<unsigned char>(word[at])) != 0;
  };
  // number_length() also accepts a point or an "e" without a following digit.
  if (!digit_at(first) || !digit_at(word.size() - 1) || number_length(word, 0) != word.size()) return false;
  const std::size_t point = word.find('.');
  return (point == std::string::npos || digit_at(point + 1)) &&
         std::isfinite(std::strtod(word.c_str(), nullptr));
}

class Explainer {
 public:
  Explainer(std::string_view text, const std::vector<JsonOpen>& open) : text_(text), open_(open) {}

  bool is_word() const { return is_word_; }

  JsonFault explain(const std::uint32_t end, JsonProgress last) {
    std::uint32_t at = skip_blanks(text_, end);
    if (last == JsonProgress::nothing) {
      return at == text_.size() ? JsonFault{at, "the document is empty; expected an object: { ... }"}
                                : value(at, false);
    }
    if (last == JsonProgress::key) {
      if (stopped(at)) return stop(at);
      if (text_[at] != ':') return {at, "a \":\" is missing between the key and its value"};
      return value(skip_blanks(text_, at + 1), false);
    }
    if (open_.empty()) {
      if (stopped(at)) return stop(at);
      return {at, "unexpected text after the end of the document; remove it"};
    }
    const bool in_array = open_.back().is_array;
    if (last == JsonProgress::opened) return in_array ? value(at, false) : key(at, false);
    if (stopped(at)) return stop(at);
    if (text_[at] == ',') {
      at = skip_blanks(text_, at + 1);
      return in_array ? value(at, true) : key(at, true);
    }
    if (text_[at] == (in_array ? '}' : ']')) {
      return {at, fmt::format("\"{}\" cannot close the {} of {}; expected \"{}\"", text_[at],
                              in_array ? "array" : "object", line_of(text_, open_.back().begin),
                              in_array ? ']' : '}')};
    }
    if (at == end && is_word_part(text_[at]) &&
        std::isdigit(static_cast<unsigned char>(text_[at - 1])) != 0) {
      // A malformed number: 01, 0x10, 5m.
      while (at > 0 && is_word_part(text_[at - 1])) --at;
      is_word_ = true;
      return {at, explain_number(word_at(text_, at))};
    }
    return {at, fmt::format("a \",\" or \"{}\" is missing before this", in_array ? ']' : '}')};
  }

 private:
  /// True at the end of the text and at characters that are invalid in every context.
  bool stopped(std::uint32_t at) const {
    return at >= text_.size() || text_[at] == '/' || text_[at] == '#' || text_[at] == 0;
  }
  JsonFault stop(std::uint32_t at) const {
    if (at < text_.size()) {
      if (text_[at] == 0) return {at, "a zero byte; a scene is plain text (UTF-8)"};
      if (text_.substr(at, 2) == "/*") return {at, "this comment is not closed; end it with */"};
      return {at, "comments start with // or stand between /* and */"};
    }
    if (open_.empty()) return {at, "unexpected end of the document; a value is missing"};
    const bool is_array = open_.back().is_array;
    return {at, fmt::format("unexpected end of the document inside the {} opened on {}; close it with \"{}\"",
                            is_array ? "array" : "object", line_of(text_, open_.back().begin),
                            is_array ? ']' : '}')};
  }

  JsonFault key(std::uint32_t at, bool after_comma) const {
    if (stopped(at)) return stop(at);
    const char c = text_[at];
    if (c == '"') return explain_text(text_, at);
    if (c == '}' && after_comma)
      return {at, "another key must follow after a \",\"; remove the comma before \"}\""};
    if (c == ',') return {at, "a key is missing before this \",\""};
    return {at, fmt::format("expected a key in double quotes: \"name\": value; found {}",
                            printable(word_at(text_, at)))};
  }

  JsonFault value(std::uint32_t at, bool after_comma) {
    if (stopped(at)) return stop(at);
    const char c = text_[at];
    if (c == '"') return explain_text(text_, at);
    if ((c == ']' || c == '}') && after_comma) {
      return {at, fmt::format("another value must follow after a \",\"; remove the comma before \"{}\"", c)};
    }
    if (c == ',' || c == ']' || c == '}' || c == ':') {
      return {at, fmt::format("a value is missing before this \"{}\"", c)};
    }
    if (c == '\'') return {at, "strings need double quotes: \"...\""};
    is_word_ = is_word_part(c);
    return {at, explain_word(word_at(text_, at))};
  }

  std::string_view text_;
  const std::vector<JsonOpen>& open_;
  bool is_word_ = false;
};

}  // namespace

std::uint32_t skip_blanks(std::string_view text, std::uint32_t at) {
  if (at == 0 && text.starts_with("\xEF\xBB\xBF")) at = 3;
  const auto size = static_cast<std::uint32_t>(text.size());
  while (at < size) {
    const char c = text[at];
    if (c == ' ' || c == '\t' || c == '\n' || c == '\r') {
      ++at;
    } else if (text.substr(at, 2) == "//") {
      const std::size_t end = text.find_first_of(std::string_view("\n\r\0", 3), at);
      at = static_cast<std::uint32_t>(std::min(end, text.size()));
    } else if (text.substr(at, 2) == "/*") {
      const std::size_t end = text.find("*/", at + 2);
      if (end == std::string_view::npos) return at;
      at = static_cast<std::uint32_t>(end + 2);
    } else {
      break;
    }
  }
  return at;
}

std::uint32_t number_length(std::string_view text, std::uint32_t at) {
  std::uint32_t end = at;
  const auto is = [&](std::string_view any) {
    return end < text.size() && any.find(text[end]) != std::string_view::npos;
  };
  const auto digits = [&] {
    while (is("0123456789")) ++end;
  };
  if (is("-")) ++end;
  if (is("0")) {
    ++end;  // no digit may follow
  } else {
    digits();
  }
  if (is(".")) {
    ++end;
    digits();
  }
  if (is("eE")) {
    ++end;
    if (is("+-")) ++end;
    digits();
  }
  return end - at;
}

bool is_utf8(std::string_view text, std::size_t* bad) {
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = [&](std::size_t k) {
      return i + k < text.size() ? static_cast<unsigned char>(text[i + k]) : 0u;
    };
    const unsigned lead = byte(0);
    std::size_t length = lead < 0x80   ? 1
                         : lead < 0xC2 ? 0
                         : lead < 0xE0 ? 2
                         : lead < 0xF0 ? 3
                         : lead < 0xF5 ? 4
                                       : 0;
    for (std::size_t k = 1; k < length; ++k) {
      if ((byte(k) & 0xC0u) != 0x80u) length = 0;
    }
    if ((lead == 0xE0 && byte(1) < 0xA0) || (lead == 0xED && byte(1) > 0x9F) ||
        (lead == 0xF0 && byte(1) < 0x90) || (lead == 0xF4 && byte(1) > 0x8F)) {
      length = 0;
    }
    if (length == 0) {
      if (bad != nullptr) *bad = i;
      return false;
    }
    i += length;
  }
  return true;
}

std::string explain_word(std::string_view word) {
  if (is_non_finite(word))
    return fmt::format("{} is not a finite number; write a finite number", printable(word));
  if (begins_number(word[0])) return explain_number(word);
  return fmt::format("{} is not a JSON value; write a number, \"text\", true, false, [ ... ] or {{ ... }}",
                     printable(word));
}

std::vector<JsonWord> bad_words(std::string_view text, std::size_t most) {
  std::vector<JsonWord> bad;
  const auto size = static_cast<std::uint32_t>(text.size());
  for (std::uint32_t at = skip_blanks(text, 0); at < size && bad.size() < most; at = skip_blanks(text, at)) {
    if (text[at] == '"') {
      for (++at; at < size && text[at] != '"'; ++at)
        if (text[at] == '\\') ++at;
      ++at;
    } else if (is_word_part(text[at])) {
      const std::string_view word = word_at(text, at);
      if (!is_value(std::string(word))) bad.push_back({at, static_cast<std::uint32_t>(word.size())});
      at += static_cast<std::uint32_t>(word.size());
    } else {
      ++at;
    }
  }
  return bad;
}

JsonFault explain_syntax(std::string_view text, std::uint32_t end, JsonProgress last,
                         const std::vector<JsonOpen>& open, bool* is_word) {
  Explainer explainer(text, open);
  JsonFault fault = explainer.explain(end, last);
  if (is_word != nullptr) *is_word = explainer.is_word();
  return fault;
}

}  // namespace collidoscope

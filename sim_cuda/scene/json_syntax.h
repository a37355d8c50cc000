#pragma once
// Explains JSON syntax errors: the position of the error, the text found and the text expected. Stateless.

#include <cstdint>
#include <string_view>
#include <vector>

#include "sim_cuda/scene/json_document.h"

namespace collidoscope {

/// Last token that the parser accepted.
enum class JsonProgress { nothing, opened, key, value };

/// An array or object without its closing bracket.
struct JsonOpen {
  std::uint32_t begin;
  bool is_array;
};

/// Skips blanks and closed comments from `at` on. Stops at the slash of an unclosed comment.
std::uint32_t skip_blanks(std::string_view text, std::uint32_t at);

/// Length of the JSON number that starts at `at`.
std::uint32_t number_length(std::string_view text, std::uint32_t at);

/// True if `text` is well-formed UTF-8 without overlong forms and surrogates. `*bad` receives the offset of
/// the first invalid byte.
bool is_utf8(std::string_view text, std::size_t* bad = nullptr);

/// Explains the error of a text that was parsed up to byte `end`; `last` is the last accepted token.
/// `*is_word` is set to true if the error is one of bad_words(). The parser can then skip it and read on.
JsonFault explain_syntax(std::string_view text, std::uint32_t end, JsonProgress last,
                         const std::vector<JsonOpen>& open, bool* is_word = nullptr);

/// A run of letters, digits and signs that is not a JSON value: NaN, 1e999, 01, True.
struct JsonWord {
  std::uint32_t begin, size;
};
/// All such words outside of strings and comments, in text order. Returns at most `most`.
std::vector<JsonWord> bad_words(std::string_view text, std::size_t most);
/// Error message for such a word.
std::string explain_word(std::string_view word);

}  // namespace collidoscope

#pragma once
// What is wrong with a text that is no JSON, in our words: where the parser stopped, what stands there and
// what would be right.

#include <cstdint>
#include <string_view>
#include <vector>

#include "sim_cuda/scene/json_document.h"

namespace collidoscope {

/// What the parser had understood before it stopped.
enum class JsonProgress { nothing, opened, key, value };

/// An array or object that is still open.
struct JsonOpen {
  std::uint32_t begin;
  bool is_array;
};

/// From `at`, over blanks and closed comments. Stops at the slash of a comment that has no end.
std::uint32_t skip_blanks(std::string_view text, std::uint32_t at);

/// The length of the number, as JSON writes them, that starts at `at`.
std::uint32_t number_length(std::string_view text, std::uint32_t at);

/// Whether `text` is well-formed UTF-8 (no overlong forms, no surrogates); `*bad` is the first bad byte.
bool is_utf8(std::string_view text, std::size_t* bad = nullptr);

/// The fault of a text that the parser understood up to byte `end`, where `last` had just been read.
/// `*is_word`: whether it is one of bad_words(), beside which the rest can be read.
JsonFault explain_syntax(std::string_view text, std::uint32_t end, JsonProgress last,
                         const std::vector<JsonOpen>& open, bool* is_word = nullptr);

/// Letters, digits and signs that stand together and are no value: NaN, 1e999, 01, True.
struct JsonWord {
  std::uint32_t begin, size;
};
/// All of them outside of texts and comments, at most `most`, in their order.
std::vector<JsonWord> bad_words(std::string_view text, std::size_t most);
/// What is wrong with one of them.
std::string explain_word(std::string_view word);

}  // namespace collidoscope

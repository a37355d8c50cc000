#include "sim_cuda/scene/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <utility>

#include "sim_cuda/scene/limits.h"

namespace collidoscope {
namespace {

/// Levenshtein distance: insertions, deletions and replacements of single letters.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row[b.size()];
}

/// Decodes the first UTF-8 character: code point and number of bytes. 0 bytes if it is invalid.
std::pair<std::uint32_t, std::size_t> first_character(std::string_view text) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const std::size_t bytes = byte(0) < 0x80   ? 1
                            : byte(0) < 0xC2 ? 0
                            : byte(0) < 0xE0 ? 2
                            : byte(0) < 0xF0 ? 3
                            : byte(0) < 0xF5 ? 4
                                             : 0;
  if (bytes == 0 || bytes > text.size()) return {0, 0};
  std::uint32_t code = bytes == 1 ? byte(0) : byte(0) & (0x7Fu >> bytes);
  for (std::size_t k = 1; k < bytes; ++k) {
    if ((byte(k) & 0xC0) != 0x80) return {0, 0};
    code = code << 6 | (byte(k) & 0x3Fu);
  }
  const bool shortest = bytes < 3 || code >= (bytes == 3 ? 0x800u : 0x10000u);
  return {code, shortest ? bytes : 0};
}

/// True for characters that a terminal interprets instead of showing: control characters, line separators,
/// bidirectional marks.
bool is_control(std::uint32_t code) {
  const auto within = [code](std::uint32_t first, std::uint32_t last) {
    return first <= code && code <= last;
  };
  return code < 0x20 || within(0x7F, 0x9F) || code == 0x61C || within(0x200E, 0x200F) ||
         within(0x2028, 0x202E) || within(0x2066, 0x2069);
}

/// Replaces control characters and invalid UTF-8 bytes with '?'.
std::string without_controls(std::string_view text) {
  std::string safe;
  while (!text.empty()) {
    const auto [code, bytes] = first_character(text);
    const bool shown = bytes > 0 && !is_control(code);
    safe += shown ? text.substr(0, bytes) : "?";
    text.remove_prefix(bytes > 0 ? bytes : 1);
  }
  return safe;
}

/// A name from a file may have any length and any content.
std::string shown(std::string_view name) { return printable(name, limits::max_name_length); }

}  // namespace

std::vector<std::string> names_of(Effects effects) {
  std::vector<std::string> names;
  for (const EffectName& effect : effect_names)
    if (effects.*(effect.flag)) names.emplace_back(effect.name);
  return names;
}

std::string either_of(std::span<const std::string_view> names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? " or " : ", ";
    text += shown(names[i]);
  }
  return text;
}

std::string_view nearest_name(std::string_view word, std::span<const std::string_view> names) {
  if (word.size() > 64) return {};
  std::size_t least = std::max<std::size_t>(1, word.size() / 3) + 1;
  std::string_view nearest;
  for (const std::string_view name : names) {
    const std::size_t distance = edit_distance(word, name);
    if (distance < least) {
      least = distance;
      nearest = name;
    }
  }
  return nearest;
}

std::string unknown_name(std::string_view what, std::string_view word,
                         std::span<const std::string_view> names) {
  std::string text = fmt::format("unknown {} \"{}\"; ", what, printable(word));
  const std::string_view nearest = nearest_name(word, names);
  if (names.empty()) return text + "none exists";
  if (names.size() == 1) return text + fmt::format("expected \"{}\"", shown(names[0]));
  if (!nearest.empty()) text += fmt::format("did you mean \"{}\"? ", shown(nearest));
  const std::string all = names.size() > 24 ? fmt::format("there are {}", names.size()) : either_of(names);
  if (nearest.empty()) return text + (names.size() > 24 ? all : "expected " + all);
  return text + "(" + all + ")";
}

std::string printable(std::string_view word, std::size_t longest) {
  std::string text(word.substr(0, longest));
  if (word.size() > longest) {
    // Do not cut within a UTF-8 character.
    while (!text.empty() && (static_cast<unsigned char>(word[text.size()]) & 0xC0) == 0x80) text.pop_back();
    text += "...";
  }
  return without_controls(text);
}

}  // namespace collidoscope

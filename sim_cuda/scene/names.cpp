#include "sim_cuda/scene/names.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim_cuda/scene/limits.h"

namespace collidoscope {
namespace {

/// Levenshtein's distance: insertions, deletions and replacements of single letters.
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

/// One that stands in a file may be of anything, and as long as it likes.
std::string shown(std::string_view name) { return printable(name, limits::max_name_length); }

}  // namespace

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
  if (names.empty()) return text + "there is none";
  if (names.size() == 1) return text + fmt::format("\"{}\" is the only one", shown(names[0]));
  if (!nearest.empty()) text += fmt::format("did you mean \"{}\"? ", shown(nearest));
  if (names.size() > 24) return text + fmt::format("(there are {})", names.size());
  return text + (nearest.empty() ? "it is " + either_of(names) : "(" + either_of(names) + ")");
}

std::string printable(std::string_view word, std::size_t longest) {
  std::string text(word.substr(0, longest));
  if (word.size() > longest) {
    // Not through the middle of a UTF-8 character.
    while (!text.empty() && (static_cast<unsigned char>(word[text.size()]) & 0xC0) == 0x80) text.pop_back();
    text += "...";
  }
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return text;
}

}  // namespace collidoscope

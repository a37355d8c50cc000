#include "capture/moved_ids.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <unordered_map>

#include "capture/words.h"

namespace collidoscope::capture {
namespace {

/// Pixels of an id: their number, and the sums of their coordinates.
struct Extent {
  std::int64_t pixels = 0, x = 0, y = 0;
};
struct Change {
  std::uint32_t id = 0;
  Extent expected, actual;
  std::int64_t different = 0;  ///< pixels that have the id in one picture only
};
using Changes = std::unordered_map<std::uint32_t, Change>;

std::uint32_t id_of(const std::uint8_t* pixel) {
  return pixel[0] | std::uint32_t{pixel[1]} << 8 | std::uint32_t{pixel[2]} << 16 |
         std::uint32_t{pixel[3]} << 24;
}

/// Adds the pixels of a picture, run by run.
void add_extents(const Pixels& picture, Extent Change::*extent, Changes& changes) {
  for (int y = 0; y < picture.height; ++y) {
    const std::uint8_t* row = picture.row(y);
    for (int first = 0, end = 0; first < picture.width; first = end) {
      const std::uint32_t id = id_of(row + 4 * first);
      for (end = first + 1; end < picture.width && id_of(row + 4 * end) == id;) ++end;
      Extent& all = changes[id].*extent;
      const std::int64_t length = end - first;
      all.pixels += length;
      all.x += length * (first + end - 1) / 2;
      all.y += length * y;
    }
  }
}

std::string text_of(const Change& change, const std::function<std::string(std::uint32_t)>& name_of) {
  const std::string name = name_of ? name_of(change.id) : words("id ", change.id);
  const Extent &before = change.expected, &now = change.actual;
  if (now.pixels == 0) return words(name, " is missing (", before.pixels, " pixels)");
  if (before.pixels == 0) return words(name, " is new (", now.pixels, " pixels)");
  const auto middle = [](std::int64_t sum, std::int64_t count) {
    return static_cast<double>(sum) / static_cast<double>(count);
  };
  const double x = middle(now.x, now.pixels) - middle(before.x, before.pixels),
               y = middle(now.y, now.pixels) - middle(before.y, before.pixels);
  const auto rounded = [](double v) { return std::round(10 * std::abs(v)) / 10; };
  std::string text = name;
  if (std::hypot(x, y) >= 0.05)
    text += words(" moved by ", rounded(std::hypot(x, y)), " pixels (", x < 0 ? "left " : "right ",
                  rounded(x), y < 0 ? ", up " : ", down ", rounded(y), ")");
  else
    text += " has another outline";
  if (now.pixels != before.pixels) text += words(", has ", now.pixels, " pixels instead of ", before.pixels);
  return text;
}

}  // namespace

std::string moved_ids_text(const Pixels& actual, const Pixels& expected,
                           const std::function<std::string(std::uint32_t)>& name_of) {
  constexpr std::size_t most_ids = 5000;
  Changes changes;
  for (int y = 0; y < actual.height; ++y) {
    const std::uint8_t *row = actual.row(y), *other = expected.row(y);
    for (int x = 0, end = 0; x < actual.width; x = end) {
      const std::uint32_t now = id_of(row + 4 * x), before = id_of(other + 4 * x);
      for (end = x + 1;
           end < actual.width && id_of(row + 4 * end) == now && id_of(other + 4 * end) == before;)
        ++end;
      if (now == before) continue;
      changes[now].different += end - x;
      changes[before].different += end - x;
    }
    if (changes.size() > most_ids) return words("more than ", most_ids, " objects");
  }
  add_extents(expected, &Change::expected, changes);
  add_extents(actual, &Change::actual, changes);
  std::vector<Change> changed;
  for (auto& [id, change] : changes) {
    change.id = id;
    if (change.different > 0) changed.push_back(change);
  }
  // The background, which has the most pixels, loses what the objects gain.
  const auto background = std::max_element(
      changed.begin(), changed.end(),
      [](const Change& a, const Change& b) { return a.expected.pixels < b.expected.pixels; });
  if (changed.size() > 1 && background != changed.end()) changed.erase(background);
  std::sort(changed.begin(), changed.end(), [](const Change& a, const Change& b) {
    return a.different != b.different ? a.different > b.different : a.id < b.id;
  });
  constexpr std::size_t most = 5;
  std::string text;
  for (std::size_t k = 0; k < std::min(changed.size(), most); ++k)
    text += (k > 0 ? "; " : "") + text_of(changed[k], name_of);
  if (changed.size() > most) text += words("; ", changed.size() - most, " more");
  return text;
}

}  // namespace collidoscope::capture

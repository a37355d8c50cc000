// Comparison of two pictures within a tolerance, in numbers and in words.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include <collidoscope/picture.h>
#include "capture/antialiasing.h"
#include "capture/moved_ids.h"
#include "capture/words.h"

namespace collidoscope::capture {
namespace {

/// Bounds and counts of marked pixels, by ninths of the picture.
class Marks {
 public:
  Marks(int width, int height) : width_(width), height_(height) {}
  /// Adds the pixels of a row with mark(x).
  template <class Mark>
  void add_row(int y, const Mark& mark) {
    std::int64_t of_row = 0;
    for (int third = 0; third < 3; ++third) {
      std::int64_t count = 0;
      for (int x = width_ * third / 3; x < width_ * (third + 1) / 3; ++x) count += mark(x) ? 1 : 0;
      ninths_[static_cast<std::size_t>(3 * (3 * y / height_) + third)] += count;
      of_row += count;
    }
    if (of_row == 0) return;
    count_ += of_row;
    low_y_ = std::min(low_y_, y), high_y_ = y;
    for (int x = 0; x < low_x_ && x < width_; ++x)
      if (mark(x)) low_x_ = x;
    for (int x = width_ - 1; x > high_x_; --x)
      if (mark(x)) high_x_ = x;
  }
  std::int64_t count() const { return count_; }
  Region bounds() const {
    return count_ == 0 ? Region{} : Region{low_x_, low_y_, high_x_ - low_x_ + 1, high_y_ - low_y_ + 1};
  }
  /// Such as "x 10 to 12, y 5 to 5, most in the upper left".
  std::string text() const {
    constexpr std::array<const char*, 9> names{"upper left", "upper middle", "upper right",
                                               "left",       "middle",       "right",
                                               "lower left", "lower middle", "lower right"};
    const auto most = std::max_element(ninths_.begin(), ninths_.end()) - ninths_.begin();
    const Region at = bounds();
    return words("x ", at.x, " to ", at.x + at.width - 1, ", y ", at.y, " to ", at.y + at.height - 1, ", ",
                 ninths_[static_cast<std::size_t>(most)] == count_ ? "in the " : "most in the ",
                 names[static_cast<std::size_t>(most)]);
  }

 private:
  int width_, height_;
  int low_x_ = 1 << 30, high_x_ = -1, low_y_ = 1 << 30, high_y_ = -1;
  std::int64_t count_ = 0;
  std::array<std::int64_t, 9> ninths_{};
};

/// The largest difference of the channels of each pixel of a row.
void find_worst(const std::uint8_t* p, const std::uint8_t* q, std::vector<std::uint8_t>& worst) {
  const auto distance = [](std::uint8_t a, std::uint8_t b) {
    return static_cast<std::uint8_t>(a > b ? a - b : b - a);
  };
  for (std::size_t x = 0; x < worst.size(); ++x)
    worst[x] = std::max(std::max(distance(p[4 * x], q[4 * x]), distance(p[4 * x + 1], q[4 * x + 1])),
                        std::max(distance(p[4 * x + 2], q[4 * x + 2]), distance(p[4 * x + 3], q[4 * x + 3])));
}

/// A copy of the picture with the ignored regions of the other one.
Picture with_ignored(const Pixels& picture, const Pixels& other, const std::vector<Region>& ignored) {
  Picture copy{picture.width, picture.height, {}};
  const auto row_bytes = static_cast<std::size_t>(picture.width) * 4;
  for (int y = 0; y < picture.height; ++y)
    copy.rgba.insert(copy.rgba.end(), picture.row(y), picture.row(y) + row_bytes);
  for (const Region& region : ignored) {
    const int low_x = std::clamp(region.x, 0, picture.width),
              high_x = std::clamp(region.x + region.width, low_x, picture.width);
    for (int y = std::max(region.y, 0); y < std::min(region.y + region.height, picture.height); ++y)
      std::copy(other.row(y) + 4 * low_x, other.row(y) + 4 * high_x,
                &copy.rgba[static_cast<std::size_t>(y) * row_bytes + 4 * static_cast<std::size_t>(low_x)]);
  }
  return copy;
}

void compare_exactly(const Pixels& actual, const Pixels& expected, const Tolerance& tolerance,
                     Comparison& result) {
  result.passed = result.different == 0;
  result.severity = static_cast<double>(result.different);
  if (!result.passed)
    result.text = words(result.different,
                        " pixels have other ids: ", moved_ids_text(actual, expected, tolerance.name_of_id));
}

void compare_tightly(const Marks& beyond, const Tolerance& tolerance, double pixels, Comparison& result) {
  const double share = static_cast<double>(result.beyond) / pixels;
  result.passed = share <= tolerance.max_share;
  result.severity = share / std::max(tolerance.max_share, 0.5 / pixels);
  if (!result.passed)
    result.text = words(percent(share), " of the pixels (", result.beyond, ") differ by more than ",
                        tolerance.max_difference, " of 255, at most ", percent(tolerance.max_share),
                        " may; the largest difference is ", result.max_difference, "; ", beyond.text());
}

void compare_loosely(const Pixels& actual, const Pixels& expected, const Marks& different,
                     const Tolerance& tolerance, double pixels, Comparison& result) {
  std::vector<float> error = flip(actual, expected);
  double sum = 0;
  for (const float value : error) sum += static_cast<double>(value);
  result.flip_mean = sum / pixels;
  const auto rank = static_cast<std::ptrdiff_t>(std::ceil(0.99 * pixels)) - 1;
  std::nth_element(error.begin(), error.begin() + rank, error.end());
  result.flip_p99 = static_cast<double>(error[static_cast<std::size_t>(rank)]);
  result.passed = result.flip_mean <= tolerance.max_mean && result.flip_p99 <= tolerance.max_p99;
  result.severity = std::max(result.flip_mean / std::max(tolerance.max_mean, 1e-6),
                             result.flip_p99 / std::max(tolerance.max_p99, 1e-6));
  if (!result.passed)
    result.text = words("the perceptual difference (FLIP, 0 to 1) has the mean ", result.flip_mean,
                        ", at most ", tolerance.max_mean, ", and the 99th percentile ", result.flip_p99,
                        ", at most ", tolerance.max_p99, "; different pixels: ", different.text());
}

}  // namespace

Tolerance exact() {
  Tolerance tolerance;
  tolerance.tier = Tier::exact;
  return tolerance;
}

Tolerance tight(int max_difference, double max_share) {
  Tolerance tolerance;
  tolerance.max_difference = max_difference;
  tolerance.max_share = max_share;
  return tolerance;
}

Tolerance loose(double max_mean, double max_p99) {
  Tolerance tolerance;
  tolerance.tier = Tier::loose;
  tolerance.max_mean = max_mean;
  tolerance.max_p99 = max_p99;
  return tolerance;
}

Comparison compare(const Pixels& actual, const Pixels& given, const Tolerance& tolerance) {
  Comparison result;
  if (actual.width != given.width || actual.height != given.height) {
    result.passed = false;
    result.severity = 1e9;
    result.text =
        words(actual.width, "x", actual.height, " pixels, expected ", given.width, "x", given.height);
    return result;
  }
  if (actual.width == 0 || actual.height == 0) return result;
  Picture copy;
  Pixels expected = given;
  if (!tolerance.ignored.empty()) {
    copy = with_ignored(given, actual, tolerance.ignored);
    expected = copy.pixels();
  }
  Marks different(actual.width, actual.height), beyond(actual.width, actual.height);
  const bool is_tight = tolerance.tier == Tier::tight;
  std::vector<std::uint8_t> worst(static_cast<std::size_t>(actual.width));  // of the channels of each pixel
  for (int y = 0; y < actual.height; ++y) {
    const std::uint8_t *p = actual.row(y), *q = expected.row(y);
    if (std::memcmp(p, q, static_cast<std::size_t>(actual.width) * 4) == 0) continue;
    find_worst(p, q, worst);
    if (is_tight && tolerance.ignore_antialiasing)
      for (int x = 0; x < actual.width; ++x)
        if (std::uint8_t& of_pixel = worst[static_cast<std::size_t>(x)];
            of_pixel > tolerance.max_difference &&
            (is_antialiased(actual, expected, x, y) || is_antialiased(expected, actual, x, y)))
          of_pixel = 0;
    different.add_row(y, [&](int x) { return worst[static_cast<std::size_t>(x)] > 0; });
    if (is_tight)
      beyond.add_row(y, [&, limit = tolerance.max_difference](int x) {
        return worst[static_cast<std::size_t>(x)] > limit;
      });
    result.max_difference =
        std::max<int>(result.max_difference, *std::max_element(worst.begin(), worst.end()));
  }
  result.different = different.count();
  result.beyond = beyond.count();
  result.where = result.beyond > 0 ? beyond.bounds() : different.bounds();
  if (result.different == 0) return result;
  const double pixels = static_cast<double>(actual.width) * actual.height;
  if (tolerance.tier == Tier::exact)
    compare_exactly(actual, expected, tolerance, result);
  else if (tolerance.tier == Tier::tight)
    compare_tightly(beyond, tolerance, pixels, result);
  else
    compare_loosely(actual, expected, different, tolerance, pixels, result);
  return result;
}

int smallest_detected_block(const Pixels& picture, const Tolerance& tolerance) {
  const int most = std::min(picture.width, picture.height);
  Picture changed{picture.width, picture.height, {}};
  const auto row_bytes = static_cast<std::size_t>(picture.width) * 4;
  for (int y = 0; y < picture.height; ++y)
    changed.rgba.insert(changed.rgba.end(), picture.row(y), picture.row(y) + row_bytes);
  const auto flip_block = [&](int side) {
    const int x = (picture.width - side) / 2, y = (picture.height - side) / 2;
    for (int row = y; row < y + side; ++row)
      for (int column = x; column < x + side; ++column)
        for (std::size_t channel = 0; channel < 3; ++channel)
          changed.rgba[static_cast<std::size_t>(row) * row_bytes + 4 * static_cast<std::size_t>(column) +
                       channel] ^= 128;
  };
  const auto is_detected = [&](int side) {
    flip_block(side);
    const bool passed = compare(changed.pixels(), picture, tolerance).passed;
    flip_block(side);
    return !passed;
  };
  int unseen = 0, seen = most + 1;
  for (int side = 1; side <= most && seen > most; side = std::min(2 * side, side < most ? most : most + 1))
    (is_detected(side) ? seen : unseen) = side;
  while (seen - unseen > 1) {
    const int side = unseen + (seen - unseen) / 2;
    if (side > most) break;
    (is_detected(side) ? seen : unseen) = side;
  }
  return seen;
}

Picture difference_picture(const Pixels& actual, const Pixels& expected, Tier tier) {
  Picture result{actual.width, actual.height, {}};
  if (tier == Tier::exact) {
    for (int y = 0; y < actual.height; ++y)
      for (int x = 0; x < actual.width; ++x) {
        const bool same =
            std::equal(actual.row(y) + 4 * x, actual.row(y) + 4 * x + 4, expected.row(y) + 4 * x);
        const std::uint8_t level = same ? 24 : 255;
        result.rgba.insert(result.rgba.end(),
                           {level, same ? level : std::uint8_t{80}, same ? level : std::uint8_t{60}, 255});
      }
    return result;
  }
  for (const float value : flip(actual, expected)) {
    const auto ramp = [&](float from) {
      return static_cast<std::uint8_t>(std::clamp((value - from) * 3, 0.0f, 1.0f) * 255);
    };
    result.rgba.insert(result.rgba.end(), {ramp(0), ramp(0.33f), ramp(0.67f), 255});
  }
  return result;
}

}  // namespace collidoscope::capture

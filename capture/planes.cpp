#include "capture/planes.h"

#include <cmath>

namespace collidoscope::capture {
namespace {

/// to[x] = kernel[0] * middle[x], to which add_taps() adds the other values.
VECTORISED void start_row(const float* middle, float weight, int width, float* to) {
  for (int x = 0; x < width; ++x) to[x] = weight * middle[x];
}

/// Adds two taps at the same distance from the middle.
VECTORISED void add_sum(const float* before, const float* after, float weight, int width, float* to) {
  for (int x = 0; x < width; ++x) to[x] += weight * (before[x] + after[x]);
}
VECTORISED void add_difference(const float* before, const float* after, float weight, int width, float* to) {
  for (int x = 0; x < width; ++x) to[x] += weight * (after[x] - before[x]);
}

VECTORISED void mix_row(const float* from, float share, float share_of_to, int width, float* to) {
  for (int x = 0; x < width; ++x) to[x] = share_of_to * to[x] + share * from[x];
}

VECTORISED void length_row(const float* other, float scale, int width, float* to) {
  for (int x = 0; x < width; ++x) to[x] = scale * std::sqrt(to[x] * to[x] + other[x] * other[x]);
}

}  // namespace

Plane filtered_across(const Plane& plane, const std::vector<float>& kernel, Parity parity, int margin) {
  Plane result(plane.width() - 2 * margin, plane.height());
  for (int y = 0; y < plane.height(); ++y) {
    const float* middle = plane.row(y) + margin;
    start_row(middle, kernel[0], result.width(), result.row(y));
    for (int k = 1; k < static_cast<int>(kernel.size()); ++k)
      (parity == Parity::even ? add_sum : add_difference)(
          middle - k, middle + k, kernel[static_cast<std::size_t>(k)], result.width(), result.row(y));
  }
  return result;
}

Plane filtered_down(const Plane& plane, const std::vector<float>& kernel, Parity parity, int margin) {
  Plane result(plane.width(), plane.height() - 2 * margin);
  for (int y = 0; y < result.height(); ++y) {
    start_row(plane.row(y + margin), kernel[0], result.width(), result.row(y));
    for (int k = 1; k < static_cast<int>(kernel.size()); ++k)
      (parity == Parity::even ? add_sum : add_difference)(
          plane.row(y + margin - k), plane.row(y + margin + k), kernel[static_cast<std::size_t>(k)],
          result.width(), result.row(y));
  }
  return result;
}

void mix(const Plane& from, float share, float share_of_to, Plane& to) {
  for (int y = 0; y < to.height(); ++y) mix_row(from.row(y), share, share_of_to, to.width(), to.row(y));
}

void length_of(const Plane& other, float scale, Plane& to) {
  for (int y = 0; y < to.height(); ++y) length_row(other.row(y), scale, to.width(), to.row(y));
}

}  // namespace collidoscope::capture

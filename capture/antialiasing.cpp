#include "capture/antialiasing.h"

#include <algorithm>
#include <cstring>

namespace collidoscope::capture {
namespace {

double brightness(const std::uint8_t* pixel) {
  return 0.299 * pixel[0] + 0.587 * pixel[1] + 0.114 * pixel[2];
}

/// Calls use(x, y) for the neighbours of a pixel. Returns their number.
template <class Use>
int for_each_neighbour(const Pixels& picture, int x, int y, const Use& use) {
  int count = 0;
  for (int ny = std::max(y - 1, 0); ny <= std::min(y + 1, picture.height - 1); ++ny)
    for (int nx = std::max(x - 1, 0); nx <= std::min(x + 1, picture.width - 1); ++nx)
      if (nx != x || ny != y) {
        use(nx, ny);
        ++count;
      }
  return count;
}

/// Whether more than two neighbours are equal to the pixel. The edge of the picture counts as one.
bool is_in_flat_area(const Pixels& picture, int x, int y) {
  int equal = 0;
  const std::uint8_t* pixel = picture.row(y) + 4 * x;
  const int neighbours = for_each_neighbour(
      picture, x, y, [&](int nx, int ny) { equal += std::memcmp(pixel, picture.row(ny) + 4 * nx, 4) == 0; });
  return equal + (neighbours < 8) > 2;
}

}  // namespace

bool is_antialiased(const Pixels& picture, const Pixels& other, int x, int y) {
  const double middle = brightness(picture.row(y) + 4 * x);
  double darkest = 0, lightest = 0;  // relative to the pixel
  int dark_x = 0, dark_y = 0, light_x = 0, light_y = 0, equal = 0;
  const int neighbours = for_each_neighbour(picture, x, y, [&](int nx, int ny) {
    const double change = brightness(picture.row(ny) + 4 * nx) - middle;
    equal += change == 0;
    if (change < darkest) darkest = change, dark_x = nx, dark_y = ny;
    if (change > lightest) lightest = change, light_x = nx, light_y = ny;
  });
  if (equal + (neighbours < 8) > 2 || darkest == 0 || lightest == 0) return false;
  const auto is_flat = [&](int nx, int ny) {
    return is_in_flat_area(picture, nx, ny) && is_in_flat_area(other, nx, ny);
  };
  return is_flat(dark_x, dark_y) || is_flat(light_x, light_y);
}

}  // namespace collidoscope::capture

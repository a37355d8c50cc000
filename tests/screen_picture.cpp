#include "tests/screen_picture.h"

#include <array>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <vector>

namespace collidoscope {
namespace {

// Fields of the header: 32 bits each, big-endian (file version 7 of xwd).
enum Field : std::size_t {
  header_size = 0,
  file_version = 1,
  screen_width = 4,
  screen_height = 5,
  byte_order = 7,
  bits_per_pixel = 11,
  bytes_per_line = 12,
  colors = 19,
  fields = 25
};

}  // namespace

Image screen_picture(const std::string& file, int x, int y, int width, int height) {
  std::ifstream stream(file, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(stream), {}};
  const auto byte = [&](std::size_t at) { return static_cast<std::uint8_t>(bytes.at(at)); };
  std::array<std::size_t, fields> header{};
  for (std::size_t k = 0; k < fields; ++k)
    for (std::size_t part = 0; part < 4; ++part) header[k] = header[k] << 8 | byte(4 * k + part);
  if (header[file_version] != 7 || header[bits_per_pixel] != 32 || header[byte_order] != 0)
    throw std::runtime_error(file + " is no picture of a screen with 32 bits per pixel");
  if (static_cast<std::size_t>(x + width) > header[screen_width] ||
      static_cast<std::size_t>(y + height) > header[screen_height])
    throw std::runtime_error("the screen is smaller than the window");
  const std::size_t first = header[header_size] + 12 * header[colors];
  Image image{width, height, {}};
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      const std::size_t at = first + static_cast<std::size_t>(y + row) * header[bytes_per_line] +
                             4 * static_cast<std::size_t>(x + column);
      for (const std::size_t part : {2u, 1u, 0u}) image.rgba.push_back(byte(at + part));
      image.rgba.push_back(255);
    }
  return image;
}

}  // namespace collidoscope

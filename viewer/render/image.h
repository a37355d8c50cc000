#pragma once
// A picture in memory, and PNG files. Owns its pixels.

#include <cstdint>
#include <string>
#include <vector>

namespace collidoscope {

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< width * height * 4, rows from the top, sRGB

  friend bool operator==(const Image&, const Image&) = default;
};

/// Writes a PNG (RGB; alpha is dropped) under a temporary name beside it and renames it: a file of this name
/// is whole or as it was. Throws MachineError. The same pixels give the same bytes.
void write_png(const Image& image, const std::string& file);
/// Throws InputError where the file is missing or not a PNG.
Image read_png(const std::string& file);

}  // namespace collidoscope

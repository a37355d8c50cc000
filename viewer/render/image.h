#pragma once
// A picture in memory, with PNG input and output. Owns its pixels.

#include <cstdint>
#include <string>
#include <vector>

namespace collidoscope {

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< width * height * 4 bytes, rows from the top, sRGB

  friend bool operator==(const Image&, const Image&) = default;
};

/// Writes a PNG (RGB, without alpha) atomically through a temporary file. Throws MachineError. Deterministic:
/// equal pixels give equal bytes.
void write_png(const Image& image, const std::string& file);
/// Throws InputError if the file is missing or not a PNG.
Image read_png(const std::string& file);

}  // namespace collidoscope

#pragma once
// Difference measures of two pictures, for the command `compare` and for tests.

#include <collidoscope/picture.h>
#include <string>

#include "viewer/render/image.h"

namespace collidoscope {

/// Not owned.
inline capture::Pixels pixels_of(const Image& image) {
  return {image.rgba.data(), image.width, image.height};
}

struct ImageDifference {
  int max_channel = 0;         ///< largest difference of any of R, G, B, A; 0 to 255
  double share_over_5 = 0;     ///< share of pixels with a channel that differs by more than 5
  double perceptual_mean = 0;  ///< mean of FLIP over the pixels, 0 to 1
  double perceptual_p99 = 0;   ///< 99th percentile of FLIP
};

/// Throws InputError if the sizes differ.
ImageDifference compare_images(const Image& a, const Image& b);

/// The `compare` command: prints the measures on stdout, as a JSON object if `json` is set. Writes no file.
/// Returns 0 if no pixel differs, else 1. Throws InputError if a file is not a PNG or the sizes differ.
int run_compare(const std::string& a, const std::string& b, bool json = false);

}  // namespace collidoscope

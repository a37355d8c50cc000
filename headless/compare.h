#pragma once
// Difference measures of two pictures. Used by `compare` and the screenshot tests.

#include <string>

#include "viewer/render/image.h"

namespace collidoscope {

struct ImageDifference {
  int max_channel = 0;         ///< largest difference of any of R, G, B, A; 0 to 255
  double share_over_5 = 0;     ///< share of pixels with a channel that differs by more than 5
  double perceptual_mean = 0;  ///< mean over pixels of a FLIP-like difference, 0 to 1; see compare.cpp
};

/// Throws InputError if the sizes differ.
ImageDifference compare_images(const Image& a, const Image& b);
/// A picture of the perceptual difference per pixel, 0 (black) to 1 (bright).
Image difference_picture(const Image& a, const Image& b);

/// The `compare` command: prints the measures on stdout, as a JSON object if `json` is set. Writes no file.
/// Returns 0 if no pixel differs, else 1. Throws InputError if a file is not a PNG or the sizes differ.
int run_compare(const std::string& a, const std::string& b, bool json = false);

}  // namespace collidoscope

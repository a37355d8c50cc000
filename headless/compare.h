#pragma once
// How different two pictures are: the measures behind `compare` and the screenshot tests.

#include <string>

#include "viewer/render/image.h"

namespace collidoscope {

struct ImageDifference {
  int max_channel = 0;         ///< largest difference of any of R, G, B, A; 0 to 255
  double share_over_5 = 0;     ///< share of pixels with a channel that differs by more than 5
  double perceptual_mean = 0;  ///< mean over pixels of a FLIP-like difference, 0 to 1; see compare.cpp
};

/// Throws InputError where the sizes differ.
ImageDifference compare_images(const Image& a, const Image& b);
/// The perceptual difference of each pixel, 0 to 1, as a picture from black to bright.
Image difference_picture(const Image& a, const Image& b);

/// The `compare` command: prints the measures on stdout (with `json`, as one JSON object). Returns 0 if no
/// pixel differs, else 1. Throws InputError where a file is no PNG or the sizes differ. Writes nothing.
int run_compare(const std::string& a, const std::string& b, bool json = false);

}  // namespace collidoscope

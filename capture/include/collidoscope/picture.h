#pragma once
// Pictures in memory, their comparison, and PNG files. No dependency but libpng.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace collidoscope::capture {

/// A picture in memory. Not owned.
struct Pixels {
  const std::uint8_t* rgba = nullptr;  ///< 4 bytes per pixel, sRGB, rows from the top
  int width = 0, height = 0;
  std::ptrdiff_t row_bytes = 0;  ///< from row to row; 0: rows follow each other

  const std::uint8_t* row(int y) const {
    return rgba + y * (row_bytes != 0 ? row_bytes : std::ptrdiff_t{4} * width);
  }
};

/// A picture that owns its pixels.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;

  Pixels pixels() const { return {rgba.data(), width, height}; }
};

struct Region {
  int x = 0, y = 0, width = 0, height = 0;  ///< pixels, from the upper left corner
};

enum class Tier {
  exact,  ///< equal pixels. A pixel is an id, for pictures that have the same pixels with every renderer
  tight,  ///< small differences, for a golden of the same renderer and version
  loose   ///< perceptual difference (FLIP), for a golden of any renderer
};

struct Tolerance {
  Tier tier = Tier::tight;
  int max_difference = 5;    ///< tight: of any channel, 0 to 255. Pixels beyond are counted
  double max_share = 0.001;  ///< tight: share of the pixels that may be beyond
  double max_mean = 0.02;    ///< loose: mean of FLIP over the picture, 0 to 1
  double max_p99 = 0.25;     ///< loose: 99th percentile of FLIP over the picture
  /// Pixels of edges that are drawn with different anti-aliasing are not counted. Tight only.
  bool ignore_antialiasing = false;
  std::vector<Region> ignored;  ///< these pixels are not compared
  /// Pixels. The test fails if it would not notice that a square block of this side has another colour. 0:
  /// not checked.
  int must_detect = 0;
  /// exact: the name of an id in messages, such as "body 17". The id has red in its lowest byte.
  std::function<std::string(std::uint32_t)> name_of_id;
};
Tolerance exact();
Tolerance tight(int max_difference = 5, double max_share = 0.001);
Tolerance loose(double max_mean = 0.02, double max_p99 = 0.25);

struct Comparison {
  bool passed = true;
  std::string text;                    ///< what differs and where; empty if passed
  std::int64_t different = 0;          ///< pixels with any difference that counts
  std::int64_t beyond = 0;             ///< of these, pixels beyond Tolerance::max_difference
  int max_difference = 0;              ///< of any channel
  double flip_mean = 0, flip_p99 = 0;  ///< loose only
  Region where;                        ///< bounds of the pixels beyond; without any, of the different ones
  double severity = 0;                 ///< the largest measured value over its limit; above 1: failed
};
/// Pictures of different sizes are not equal; they are not compared further.
Comparison compare(const Pixels& actual, const Pixels& expected, const Tolerance& tolerance);

/// FLIP (Andersson et al. 2020) of two pictures of one size, by pixel, 0 to 1. Alpha is ignored. The default
/// is a screen of 3840 pixels in 0.7 m, seen from 0.7 m.
std::vector<float> flip(const Pixels& a, const Pixels& b, double pixels_per_degree = 67.0206432);

/// Side in pixels of the smallest square block in the middle of the picture whose change the comparison
/// notices: its colour channels change by 128. Larger than the picture: none is noticed.
int smallest_detected_block(const Pixels& picture, const Tolerance& tolerance);

/// The difference of two pictures of one size as a picture: FLIP, black to white; of the tier exact, the
/// changed pixels in red.
Picture difference_picture(const Pixels& actual, const Pixels& expected, Tier tier = Tier::loose);

/// Throws std::runtime_error.
Picture read_png(const std::filesystem::path& file);
void write_png(const Pixels& pixels, const std::filesystem::path& file);

}  // namespace collidoscope::capture

// FLIP for pictures of 8 bits, after Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild:
// FLIP: A Difference Evaluator for Alternating Images, 2020. All filters are separable, and are applied to
// planes of floats, row by row, so that the compiler can use vector instructions. The result is 0 away from
// different pixels, so only the part around them is computed.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>

#include <collidoscope/picture.h>
#include "capture/planes.h"

namespace collidoscope::capture {
namespace {

// ---- powers, without library calls, so that loops over them are vectorised. Relative error below 1e-6 ----

/// x > 0.
inline float log2_of(float x) {
  const std::int32_t bits = std::bit_cast<std::int32_t>(x);
  // The mantissa is in [sqrt(1/2), sqrt(2)).
  const std::int32_t exponent = (bits - 0x3f3504f3) >> 23;
  const float m = std::bit_cast<float>(bits - (exponent << 23));
  // log2((1 + t) / (1 - t)) as a series in t.
  const float t = (m - 1) / (m + 1), u = t * t;
  const float series = 1 + u * (1 / 3.0f + u * (1 / 5.0f + u * (1 / 7.0f + u * (1 / 9.0f))));
  return static_cast<float>(exponent) + 2 / std::numbers::ln2_v<float> * t * series;
}

/// -120 < x < 120.
inline float exp2_of(float x) {
  const float whole = static_cast<float>(static_cast<std::int32_t>(x + 128.5f) - 128);
  const float f = (x - whole) * std::numbers::ln2_v<float>;
  const float series =
      1 + f * (1 + f * (1 / 2.0f + f * (1 / 6.0f + f * (1 / 24.0f + f * (1 / 120.0f + f * (1 / 720.0f))))));
  return series * std::bit_cast<float>((static_cast<std::int32_t>(whole) + 127) << 23);
}

/// 0 <= x, 0 < exponent.
inline float power_of(float x, float exponent) {
  constexpr float least = 1e-30f;
  const float power = exp2_of(exponent * log2_of(std::max(x, least)));
  return x > least ? power : 0;
}

/// Of a positive number.
inline float cube_root_of(float x) {
  const auto bits = static_cast<float>(std::bit_cast<std::int32_t>(x));
  float root = std::bit_cast<float>(static_cast<std::int32_t>(bits * (1 / 3.0f)) + 0x2a514067);
  for (int k = 0; k < 3; ++k) root = (2 * root + x / (root * root)) * (1 / 3.0f);
  return root;
}

// ---- colours ----

struct Color {
  float x, y, z;
};

// sRGB with the white point D65.
constexpr float white_x = 0.950428545f, white_z = 1.088900371f;

/// Relative to white.
inline Color xyz_of(const Color& c) {
  return {
      (10135552.0f / 24577794.0f * c.x + 8788810.0f / 24577794.0f * c.y + 4435075.0f / 24577794.0f * c.z) *
          (1 / white_x),
      2613072.0f / 12288897.0f * c.x + 8788810.0f / 12288897.0f * c.y + 887015.0f / 12288897.0f * c.z,
      (1425312.0f / 73733382.0f * c.x + 8788810.0f / 73733382.0f * c.y + 70074185.0f / 73733382.0f * c.z) *
          (1 / white_z)};
}

/// The opponent space YCxCz.
inline Color opponent_of(const Color& rgb) {
  const Color p = xyz_of(rgb);
  return {116 * p.y - 16, 500 * (p.x - p.y), 200 * (p.y - p.z)};
}

/// L*a*b* of an opponent colour whose linear RGB is limited to [0, 1], with chroma scaled by lightness (Hunt
/// effect).
inline Color hunt_lab_of(float luminance, float red_green, float blue_yellow) {
  const float y = (luminance + 16) * (1 / 116.0f);
  const float x = (y + red_green * (1 / 500.0f)) * white_x, z = (y - blue_yellow * (1 / 200.0f)) * white_z;
  const auto limit = [](float v) { return std::min(std::max(v, 0.0f), 1.0f); };
  Color p = xyz_of({limit(3.241003275f * x - 1.537398934f * y - 0.498615861f * z),
                    limit(-0.969224334f * x + 1.875930071f * y + 0.041554224f * z),
                    limit(0.055639423f * x - 0.204011202f * y + 1.057148933f * z)});
  const auto curve = [](float v) {
    constexpr float delta = 6.0f / 29.0f;
    const float root = cube_root_of(std::max(v, 1e-4f));
    return v > delta * delta * delta ? root : v * (1 / (3 * delta * delta)) + 4.0f / 29.0f;
  };
  p = {curve(p.x), curve(p.y), curve(p.z)};
  const float lightness = 116 * p.y - 16;
  return {lightness, 0.01f * lightness * 500 * (p.x - p.y), 0.01f * lightness * 200 * (p.y - p.z)};
}

inline float hyab(const Color& a, const Color& b) {
  const float u = a.y - b.y, v = a.z - b.z;
  return std::abs(a.x - b.x) + std::sqrt(u * u + v * v);
}

const std::array<float, 256>& linear_values() {
  static const std::array<float, 256> values = [] {
    std::array<float, 256> table{};
    for (std::size_t k = 0; k < table.size(); ++k) {
      const double v = static_cast<double>(k) / 255;
      table[k] = static_cast<float>(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
    }
    return table;
  }();
  return values;
}

// ---- filters ----

/// Gaussian exp(-pi^2 x^2 / b) of a contrast sensitivity, x in degrees. Its sum is `sum`.
std::vector<float> sensitivity(double b, double pixels_per_degree, int radius, double& sum) {
  std::vector<double> values;
  sum = 0;
  for (int k = 0; k <= radius; ++k) {
    const double x = k / pixels_per_degree;
    values.push_back(std::exp(-std::numbers::pi * std::numbers::pi * x * x / b));
    sum += (k == 0 ? 1 : 2) * values.back();
  }
  std::vector<float> kernel;
  for (const double value : values) kernel.push_back(static_cast<float>(value / sum));
  while (kernel.size() > 1 && kernel.back() < 1e-7f) kernel.pop_back();
  return kernel;
}

/// Half of the kernels of FLIP, from the middle on; `edge` is odd, the others are even.
struct Kernels {
  std::vector<float> luminance, red_green, wide, narrow, blur, edge, point;
  float share_of_wide = 0;  ///< of blue-yellow, which has two Gaussians
  int radius = 0;

  explicit Kernels(double pixels_per_degree) {
    constexpr double pi = std::numbers::pi;
    const int radius_of_color =
        static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * pi * pi)) * pixels_per_degree));
    double sum = 0, sum_wide = 0, sum_narrow = 0;
    luminance = sensitivity(0.0047, pixels_per_degree, radius_of_color, sum);
    red_green = sensitivity(0.0053, pixels_per_degree, radius_of_color, sum);
    wide = sensitivity(0.04, pixels_per_degree, radius_of_color, sum_wide);
    narrow = sensitivity(0.025, pixels_per_degree, radius_of_color, sum_narrow);
    const double weight_of_wide = 34.1 * std::sqrt(pi / 0.04) * sum_wide * sum_wide,
                 weight_of_narrow = 13.5 * std::sqrt(pi / 0.025) * sum_narrow * sum_narrow;
    share_of_wide = static_cast<float>(weight_of_wide / (weight_of_wide + weight_of_narrow));

    const double deviation = 0.5 * 0.082 * pixels_per_degree;
    const int radius_of_features = static_cast<int>(std::ceil(3 * deviation));
    std::vector<double> g, dg, ddg;
    double sum_g = 0, sum_dg = 0, positive = 0, negative = 0;
    for (int k = 0; k <= radius_of_features; ++k) {
      const double twice = k == 0 ? 1 : 2;
      g.push_back(std::exp(-k * k / (2 * deviation * deviation)));
      dg.push_back(-k * g.back());
      ddg.push_back((k * k / (deviation * deviation) - 1) * g.back());
      sum_g += twice * g.back();
      sum_dg -= dg.back();
      (ddg.back() > 0 ? positive : negative) += twice * std::abs(ddg.back());
    }
    for (std::size_t k = 0; k < g.size(); ++k) {
      blur.push_back(static_cast<float>(g[k] / sum_g));
      edge.push_back(static_cast<float>(dg[k] / sum_dg));
      point.push_back(static_cast<float>(ddg[k] / (ddg[k] > 0 ? positive : negative)));
    }
    radius = std::max(radius_of_color, radius_of_features);
  }
};

/// The different part of two pictures, with a margin in which filters can read. `at`: without the margin.
struct Part {
  Region at;
  int margin;
};

/// Opponent colours of a part; pixels beyond the picture repeat its edge.
std::array<Plane, 3> opponent_planes(const Pixels& picture, const Part& part) {
  const int width = part.at.width + 2 * part.margin, height = part.at.height + 2 * part.margin;
  std::array<Plane, 3> planes{Plane(width, height), Plane(width, height), Plane(width, height)};
  const std::array<float, 256>& linear = linear_values();
  for (int y = 0; y < height; ++y) {
    const std::uint8_t* row = picture.row(std::clamp(part.at.y - part.margin + y, 0, picture.height - 1));
    for (int x = 0; x < width; ++x) {
      const std::uint8_t* pixel = row + 4 * std::clamp(part.at.x - part.margin + x, 0, picture.width - 1);
      const Color color = opponent_of({linear[pixel[0]], linear[pixel[1]], linear[pixel[2]]});
      planes[0].row(y)[x] = color.x;
      planes[1].row(y)[x] = color.y;
      planes[2].row(y)[x] = color.z;
    }
  }
  return planes;
}

/// What is seen of a part: colours, and the strength of edges and points.
struct Seen {
  Plane luminance, red_green, blue_yellow, edge, point;
};

Seen seen(const Pixels& picture, const Part& part, const Kernels& kernels) {
  const std::array<Plane, 3> opponent = opponent_planes(picture, part);
  const auto even = [&](const Plane& plane, const std::vector<float>& x, const std::vector<float>& y) {
    return filtered_down(filtered_across(plane, x, Parity::even, part.margin), y, Parity::even, part.margin);
  };
  Seen result;
  result.luminance = even(opponent[0], kernels.luminance, kernels.luminance);
  result.red_green = even(opponent[1], kernels.red_green, kernels.red_green);
  result.blue_yellow = even(opponent[2], kernels.wide, kernels.wide);
  mix(even(opponent[2], kernels.narrow, kernels.narrow), 1 - kernels.share_of_wide, kernels.share_of_wide,
      result.blue_yellow);
  const Plane blurred = filtered_across(opponent[0], kernels.blur, Parity::even, part.margin);
  const auto strength = [&](const std::vector<float>& kernel, Parity parity) {
    Plane across = filtered_down(filtered_across(opponent[0], kernel, parity, part.margin), kernels.blur,
                                 Parity::even, part.margin);
    length_of(filtered_down(blurred, kernel, parity, part.margin), 1 / 116.0f, across);
    return across;
  };
  result.edge = strength(kernels.edge, Parity::odd);
  result.point = strength(kernels.point, Parity::even);
  return result;
}

constexpr float color_power = 0.7f, knee_share = 0.4f, value_at_knee = 0.95f;

/// The largest difference of two colours: green and blue.
float greatest_color_difference() {
  const auto lab = [](const Color& rgb) {
    const Color p = opponent_of(rgb);
    return hunt_lab_of(p.x, p.y, p.z);
  };
  return std::pow(hyab(lab({0, 1, 0}), lab({0, 0, 1})), color_power);
}

VECTORISED void differences(const Seen& a, const Seen& b, int y, float greatest, float* result) {
  const float knee = knee_share * greatest;
  const float *a0 = a.luminance.row(y), *a1 = a.red_green.row(y), *a2 = a.blue_yellow.row(y);
  const float *b0 = b.luminance.row(y), *b1 = b.red_green.row(y), *b2 = b.blue_yellow.row(y);
  const float *edge_a = a.edge.row(y), *edge_b = b.edge.row(y), *point_a = a.point.row(y),
              *point_b = b.point.row(y);
  for (int x = 0; x < a.luminance.width(); ++x) {
    const float distance = hyab(hunt_lab_of(a0[x], a1[x], a2[x]), hunt_lab_of(b0[x], b1[x], b2[x]));
    const float raised = power_of(distance, color_power);
    const float below = raised * (value_at_knee / knee),
                above = value_at_knee + (raised - knee) * ((1 - value_at_knee) / (greatest - knee));
    const float color = std::min(raised < knee ? below : above, 1.0f);
    const float feature = std::max(std::abs(edge_a[x] - edge_b[x]), std::abs(point_a[x] - point_b[x]));
    const float exponent = 1 - std::sqrt(std::min(feature * (1 / std::numbers::sqrt2_v<float>), 1.0f));
    result[x] = power_of(color, exponent);
  }
}

/// Bounds of the different pixels; empty if there are none.
Region different_part(const Pixels& a, const Pixels& b) {
  int low_x = a.width, high_x = -1, low_y = a.height, high_y = -1;
  const auto row_bytes = static_cast<std::size_t>(a.width) * 4;
  for (int y = 0; y < a.height; ++y) {
    const std::uint8_t *p = a.row(y), *q = b.row(y);
    if (std::memcmp(p, q, row_bytes) == 0) continue;
    low_y = std::min(low_y, y);
    high_y = y;
    const auto differs = [&](int x) { return std::memcmp(p + 4 * x, q + 4 * x, 3) != 0; };
    for (int x = 0; x < low_x; ++x)
      if (differs(x)) low_x = x;
    for (int x = a.width - 1; x > high_x; --x)
      if (differs(x)) high_x = x;
  }
  if (high_x < 0) return {};
  return {low_x, low_y, high_x - low_x + 1, high_y - low_y + 1};
}

}  // namespace

std::vector<float> flip(const Pixels& a, const Pixels& b, double pixels_per_degree) {
  std::vector<float> result(static_cast<std::size_t>(a.width) * static_cast<std::size_t>(a.height));
  const Region different = different_part(a, b);
  if (different.width == 0) return result;
  const Kernels kernels(pixels_per_degree);
  const int low_x = std::max(different.x - kernels.radius, 0),
            low_y = std::max(different.y - kernels.radius, 0);
  const int high_x = std::min(different.x + different.width + kernels.radius, a.width),
            high_y = std::min(different.y + different.height + kernels.radius, a.height);
  // Parts of some rows each stay in the cache.
  constexpr int rows = 64;
  const float greatest = greatest_color_difference();
  for (int first = low_y; first < high_y; first += rows) {
    const Part part{{low_x, first, high_x - low_x, std::min(rows, high_y - first)}, kernels.radius};
    const Seen seen_a = seen(a, part, kernels), seen_b = seen(b, part, kernels);
    for (int y = 0; y < part.at.height; ++y)
      differences(seen_a, seen_b, y, greatest,
                  &result[static_cast<std::size_t>(first + y) * static_cast<std::size_t>(a.width) +
                          static_cast<std::size_t>(low_x)]);
  }
  return result;
}

}  // namespace collidoscope::capture

#include "headless/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <vector>

#include "headless/cli/standard_output.h"
#include "sim_cuda/core/error.h"

// The perceptual measure follows FLIP (Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom and Fairchild
// 2020) for 8-bit pictures at 67 pixels per degree (0.7 m from a 0.7 m wide screen of 3840 pixels).
// Simplifications: alpha is ignored, the white point constants are rounded, and sums are in float. Values
// agree with the published program to about three digits.

namespace collidoscope {
namespace {

constexpr double pixels_per_degree = 67;
using Pixel = std::array<float, 3>;

struct ImagePlane {
  int width, height;
  std::vector<Pixel> at;
};

float to_linear(std::uint8_t byte) {
  const float value = static_cast<float>(byte) / 255.0f;
  return value <= 0.04045f ? value / 12.92f : std::pow((value + 0.055f) / 1.055f, 2.4f);
}

Pixel to_xyz(const Pixel& c) {  // relative to white D65
  return {(0.4124564f * c[0] + 0.3575761f * c[1] + 0.1804375f * c[2]) / 0.9504559f,
          0.2126729f * c[0] + 0.7151522f * c[1] + 0.0721750f * c[2],
          (0.0193339f * c[0] + 0.1191920f * c[1] + 0.9503041f * c[2]) / 1.0890578f};
}

Pixel to_opponent(const Pixel& rgb) {
  const Pixel p = to_xyz(rgb);
  return {116 * p[1] - 16, 500 * (p[0] - p[1]), 200 * (p[1] - p[2])};
}

Pixel from_opponent(const Pixel& o) {
  const float y = (o[0] + 16) / 116;
  const float x = (y + o[1] / 500) * 0.9504559f, z = (y - o[2] / 200) * 1.0890578f;
  const auto unit = [](float v) { return std::clamp(v, 0.0f, 1.0f); };
  return {unit(3.2404542f * x - 1.5371385f * y - 0.4985314f * z),
          unit(-0.9692660f * x + 1.8760108f * y + 0.0415560f * z),
          unit(0.0556434f * x - 0.2040259f * y + 1.0572252f * z)};
}

// L*a*b* with chroma scaled by lightness (Hunt effect).
Pixel to_hunt_lab(const Pixel& rgb) {
  Pixel f = to_xyz(rgb);
  for (float& v : f) v = v > 0.008856452f ? std::cbrt(v) : v / 0.12841855f + 0.13793103f;
  const float lightness = 116 * f[1] - 16;
  return {lightness, 0.01f * lightness * 500 * (f[0] - f[1]), 0.01f * lightness * 200 * (f[1] - f[2])};
}

float hyab(const Pixel& a, const Pixel& b) {
  return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

// One kernel per channel, applied along x, then along y. The edge pixels are repeated.
using Kernels = std::array<std::vector<float>, 3>;
ImagePlane filtered(const ImagePlane& source, const Kernels& along_x, const Kernels& along_y) {
  ImagePlane current = source;
  for (int pass = 0; pass < 2; ++pass) {
    const Kernels& kernels = pass == 0 ? along_x : along_y;
    ImagePlane next{source.width, source.height, std::vector<Pixel>(source.at.size(), Pixel{})};
    for (int y = 0; y < source.height; ++y)
      for (int x = 0; x < source.width; ++x) {
        Pixel& out = next.at[static_cast<std::size_t>(y) * static_cast<std::size_t>(source.width) +
                             static_cast<std::size_t>(x)];
        for (std::size_t c = 0; c < 3; ++c) {
          const int radius = static_cast<int>(kernels[c].size() / 2);
          float sum = 0;
          for (int k = -radius; k <= radius; ++k) {
            const int sx = pass == 0 ? std::clamp(x + k, 0, source.width - 1) : x;
            const int sy = pass == 0 ? y : std::clamp(y + k, 0, source.height - 1);
            sum += kernels[c][static_cast<std::size_t>(k + radius)] *
                   current.at[static_cast<std::size_t>(sy) * static_cast<std::size_t>(source.width) +
                              static_cast<std::size_t>(sx)][c];
          }
          out[c] = sum;
        }
      }
    current = std::move(next);
  }
  return current;
}

// Gaussian of the contrast sensitivity function: exp(-pi^2 x^2 / b), x in degrees. Sums to `weight`.
std::vector<float> sensitivity(double b, double weight) {
  const int radius =
      std::max(1, static_cast<int>(std::ceil(3 * std::sqrt(b / (2 * std::numbers::pi * std::numbers::pi)) *
                                             pixels_per_degree)));
  std::vector<float> kernel;
  double sum = 0;
  for (int k = -radius; k <= radius; ++k) {
    const double x = k / pixels_per_degree,
                 value = std::exp(-std::numbers::pi * std::numbers::pi * x * x / b);
    kernel.push_back(static_cast<float>(value));
    sum += value;
  }
  for (float& value : kernel) value = static_cast<float>(value * weight / sum);
  return kernel;
}

ImagePlane seen(const ImagePlane& opponent) {
  // Luminance and red-green use one Gaussian each. Blue-yellow is the sum of two, weighted by their volumes a
  // (pi / b)^(1/2) * (b / pi) in both directions.
  const double volume_1 = 34.1 * std::sqrt(std::numbers::pi / 0.04) * 0.04,
               volume_2 = 13.5 * std::sqrt(std::numbers::pi / 0.025) * 0.025;
  const double share_1 = volume_1 / (volume_1 + volume_2);
  const std::vector<float> luminance = sensitivity(0.0047, 1), red_green = sensitivity(0.0053, 1);
  const Kernels wide{luminance, red_green, sensitivity(0.04, 1)};
  const Kernels narrow{std::vector<float>{1}, std::vector<float>{1}, sensitivity(0.025, 1)};
  ImagePlane result = filtered(opponent, wide, wide);
  const ImagePlane other = filtered(opponent, narrow, narrow);
  for (std::size_t i = 0; i < result.at.size(); ++i)
    result.at[i][2] = static_cast<float>(share_1 * result.at[i][2] + (1 - share_1) * other.at[i][2]);
  return result;
}

// Edge and point features of luminance: |gradient| and |second derivative| of a Gaussian, in x and y.
std::vector<std::array<float, 2>> features(const ImagePlane& opponent) {
  const double deviation = 0.5 * 0.082 * pixels_per_degree;
  const int radius = static_cast<int>(std::ceil(3 * deviation));
  std::vector<float> blur, edge, point;
  const auto balance = [](std::vector<float>& kernel) {  // scales positive values to the sum 1, negative
                                                         // values to -1
    float up = 0, down = 0;
    for (float v : kernel) (v > 0 ? up : down) += std::abs(v);
    for (float& v : kernel) v /= v > 0 ? up : down > 0 ? down : 1;
  };
  double sum = 0;
  for (int k = -radius; k <= radius; ++k) {
    const double g = std::exp(-k * k / (2 * deviation * deviation));
    blur.push_back(static_cast<float>(g));
    sum += g;
    edge.push_back(static_cast<float>(-k * g));
    point.push_back(static_cast<float>((k * k / (deviation * deviation) - 1) * g));
  }
  for (float& v : blur) v = static_cast<float>(v / sum);
  balance(edge);
  balance(point);
  ImagePlane luminance = opponent;
  for (Pixel& p : luminance.at) p = {(p[0] + 16) / 116, (p[0] + 16) / 116, 0};
  const ImagePlane across = filtered(luminance, {edge, point, {1}}, {blur, blur, {1}});
  const ImagePlane down = filtered(luminance, {blur, blur, {1}}, {edge, point, {1}});
  std::vector<std::array<float, 2>> result(luminance.at.size());
  for (std::size_t i = 0; i < result.size(); ++i)
    for (std::size_t c = 0; c < 2; ++c) result[i][c] = std::hypot(across.at[i][c], down.at[i][c]);
  return result;
}

ImagePlane opponent_plane(const Image& image) {
  static const std::array<float, 256> linear = [] {
    std::array<float, 256> table;
    for (int i = 0; i < 256; ++i)
      table[static_cast<std::size_t>(i)] = to_linear(static_cast<std::uint8_t>(i));
    return table;
  }();
  ImagePlane plane{image.width, image.height, {}};
  for (std::size_t i = 0; i + 3 < image.rgba.size(); i += 4)
    plane.at.push_back(
        to_opponent({linear[image.rgba[i]], linear[image.rgba[i + 1]], linear[image.rgba[i + 2]]}));
  return plane;
}

std::vector<float> perceptual_difference(const Image& a, const Image& b) {
  const ImagePlane opponent_a = opponent_plane(a), opponent_b = opponent_plane(b);
  const ImagePlane seen_a = seen(opponent_a), seen_b = seen(opponent_b);
  const auto features_a = features(opponent_a), features_b = features(opponent_b);
  const float greatest = std::pow(hyab(to_hunt_lab({0, 1, 0}), to_hunt_lab({0, 0, 1})), 0.7f);
  const float knee = 0.4f * greatest;
  std::vector<float> result(seen_a.at.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    const float color = std::pow(
        hyab(to_hunt_lab(from_opponent(seen_a.at[i])), to_hunt_lab(from_opponent(seen_b.at[i]))), 0.7f);
    const float spread =
        color < knee ? 0.95f / knee * color : 0.95f + 0.05f * (color - knee) / (greatest - knee);
    const float feature = std::max(std::abs(features_a[i][0] - features_b[i][0]),
                                   std::abs(features_a[i][1] - features_b[i][1]));
    result[i] = std::pow(std::min(spread, 1.0f),
                         1 - std::sqrt(std::min(feature / std::numbers::sqrt2_v<float>, 1.0f)));
  }
  return result;
}

void require_same_size(const Image& a, const Image& b) {
  if (a.width == b.width && a.height == b.height) return;
  throw InputError(fmt::format("compare: the pictures are {}x{} and {}x{}; expected the same size", a.width,
                               a.height, b.width, b.height));
}

}  // namespace

ImageDifference compare_images(const Image& a, const Image& b) {
  require_same_size(a, b);
  ImageDifference result;
  std::size_t over = 0;
  for (std::size_t i = 0; i < a.rgba.size(); i += 4) {
    int worst = 0;
    for (std::size_t c = 0; c < 4; ++c) worst = std::max(worst, std::abs(a.rgba[i + c] - b.rgba[i + c]));
    result.max_channel = std::max(result.max_channel, worst);
    over += worst > 5;
  }
  if (result.max_channel == 0) return result;
  const std::vector<float> difference = perceptual_difference(a, b);
  double sum = 0;
  for (float value : difference) sum += value;
  result.share_over_5 = static_cast<double>(over) / static_cast<double>(difference.size());
  result.perceptual_mean = sum / static_cast<double>(difference.size());
  return result;
}

Image difference_picture(const Image& a, const Image& b) {
  require_same_size(a, b);
  Image result{a.width, a.height, {}};
  for (float value : perceptual_difference(a, b)) {
    const auto ramp = [&](float from) {
      return static_cast<std::uint8_t>(std::clamp((value - from) * 3, 0.0f, 1.0f) * 255);
    };
    result.rgba.insert(result.rgba.end(), {ramp(0), ramp(0.33f), ramp(0.67f), 255});
  }
  return result;
}

int run_compare(const std::string& a, const std::string& b, bool json) {
  const Image first = read_png(a), second = read_png(b);
  const ImageDifference d = compare_images(first, second);
  if (json)
    print(fmt::format("{{\"max_channel\": {}, \"share_over_5\": {}, \"perceptual_mean\": {}}}\n",
                      d.max_channel, d.share_over_5, d.perceptual_mean));
  else
    print(
        fmt::format("largest channel difference  {} of 255\npixels over 5 of 255        {:.4f} %\nperceptual "
                    "mean (FLIP-like) {:.6f}\n",
                    d.max_channel, 100 * d.share_over_5, d.perceptual_mean));
  return d.max_channel == 0 ? 0 : 1;
}

}  // namespace collidoscope

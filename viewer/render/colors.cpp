#include "viewer/render/colors.h"

#include <algorithm>
#include <cmath>

namespace collidoscope {

namespace {

// Samples a polynomial of degree six at 256 points from `from` to `to`.
std::array<Rgb, 256> sampled(const double (&c)[7][3], double from, double to) {
  std::array<Rgb, 256> result;
  for (int i = 0; i < 256; ++i) {
    const double t = from + (to - from) * i / 255;
    double value[3];
    for (int k = 0; k < 3; ++k) {
      double sum = 0;
      for (int n = 6; n >= 0; --n) sum = sum * t + c[n][k];
      value[k] = std::clamp(sum, 0.0, 1.0);
    }
    result[static_cast<std::size_t>(i)] = {static_cast<float>(value[0]), static_cast<float>(value[1]),
                                           static_cast<float>(value[2])};
  }
  return result;
}

// Viridis and inferno (Smith, van der Walt and Firing 2015), fitted by M. Zucker.
constexpr double viridis[7][3] = {{0.2777273272234177, 0.005407344544966578, 0.3340998053353061},
                                  {0.1050930431085774, 1.404613529898575, 1.384590162594685},
                                  {-0.3308618287255563, 0.214847559468213, 0.09509516302823659},
                                  {-4.634230498983486, -5.799100973351585, -19.33244095627987},
                                  {6.228269936347081, 14.17993336680509, 56.69055260068105},
                                  {4.776384997670288, -13.74514537774601, -65.35303263337234},
                                  {-5.435455855934631, 4.645852612178535, 26.3124352495832}};
constexpr double inferno[7][3] = {{0.0002189403691192265, 0.001651004631001012, -0.01948089843709184},
                                  {0.1065134194856116, 0.5639564367884091, 3.932712388889277},
                                  {11.60249308247187, -3.972853965665698, -15.9423941062914},
                                  {-41.70399613139459, 17.43639888205313, 44.35414519872813},
                                  {77.162935699427, -33.40235894210092, -81.80730925738993},
                                  {-71.31942824499214, 32.62606426397723, 73.20951985803202},
                                  {25.13112622477341, -12.24266895238567, -23.07032500287172}};

}  // namespace

// The darkest part of each map is omitted, since it is invisible against the backdrop.
const std::array<Rgb, 256>& color_map() {
  static const std::array<Rgb, 256> map = sampled(viridis, 0.1, 1);
  return map;
}

const std::array<Rgb, 256>& heat_map() {
  static const std::array<Rgb, 256> map = sampled(inferno, 0.3, 0.97);
  return map;
}

Rgb level_color(int level, int first, int last) {
  const double at = last > first ? static_cast<double>(level - first) / (last - first) : 1;
  // The darkest thin lines would be invisible against the backdrop.
  return heat_map()[static_cast<std::size_t>(std::lround(255 * (0.12 + 0.88 * std::clamp(at, 0.0, 1.0))))];
}

MarkStyle mark_style(BoxMark mark) {
  switch (mark) {
    case BoxMark::path:
      break;
    case BoxMark::node:
      return {{1.00f, 1.00f, 1.00f}, 2.6f};
    case BoxMark::left:
      return {{0.30f, 0.85f, 1.00f}, 1.5f};
    case BoxMark::right:
      return {{0.96f, 0.45f, 0.85f}, 1.5f};
    case BoxMark::met:
      return {{0.45f, 0.92f, 0.50f}, 0.9f};
    case BoxMark::apart:
      return {{0.95f, 0.36f, 0.33f}, 0.7f};
    case BoxMark::current:
      return {{1.00f, 1.00f, 1.00f}, 2.6f};
  }
  return {{1, 1, 1}, 1};
}

Rgb contact_color(double strength) {
  static constexpr Rgb ramp[3] = {{0.52f, 0.12f, 0.26f}, {1.00f, 0.27f, 0.24f}, {1.00f, 0.93f, 0.80f}};
  const double at = std::clamp(2 * strength, 0.0, 2.0);
  const Rgb &low = ramp[at < 1 ? 0 : 1], &high = ramp[at < 1 ? 1 : 2];
  const auto t = static_cast<float>(at < 1 ? at : at - 1);
  return {low.r + t * (high.r - low.r), low.g + t * (high.g - low.g), low.b + t * (high.b - low.b)};
}

ColorMeaning color_meaning(BodyColor color) {
  switch (color) {
    case BodyColor::speed:
      return {"speed", "m/s"};
    case BodyColor::radius:
      return {"radius", "m"};
    case BodyColor::id:
      return {"id", ""};
    case BodyColor::contacts:
      return {"contacts per body", ""};
    case BodyColor::order:
      return {"tree order", ""};
    case BodyColor::depth:
      return {"tree depth", ""};
    case BodyColor::visits:
      return {"query visits per body", ""};
    case BodyColor::sleep:
      return {"sleep state", ""};
    case BodyColor::error:
      return {"error", "m"};
  }
  return {"", ""};
}

ColorMeaning color_meaning(NodeMetric metric) {
  switch (metric) {
    case NodeMetric::level:
      return {"level", ""};
    case NodeMetric::sah_share:
      return {"share of SAH cost", ""};
    case NodeMetric::sibling_overlap:
      return {"sibling overlap", ""};
    case NodeMetric::empty_space:
      return {"empty space", ""};
    case NodeMetric::visits:
      return {"visits per box", "queries"};
  }
  return {"", ""};
}

}  // namespace collidoscope

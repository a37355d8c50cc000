#include "viewer/render/value_range.h"

#include <algorithm>
#include <cmath>

#include "sim_cuda/core/stage_clock.h"
#include "sim_cuda/core/statistics.h"

namespace collidoscope {
namespace {

// Rounds up to two significant digits for legends: 17.3 becomes 18.
double rounded_up_to_digits(double value) {
  if (!(value > 0) || !std::isfinite(value)) return 1;
  const double unit = std::pow(10, std::floor(std::log10(value)) - 1);
  return std::ceil(value / unit - 1e-9) * unit;
}

// First to last level that contains leaves.
ValueRange leaf_levels(World& world) {
  const std::vector<std::int64_t>& leaves = world.tree().leaves();
  const auto first = std::ranges::find_if(leaves, [](std::int64_t n) { return n > 0; });
  return {static_cast<double>(first - leaves.begin()), static_cast<double>(std::ssize(leaves) - 1)};
}

ValueRange color_range(World& world, const FrameScene& scene, BodyColor color, const StepStats& stats) {
  switch (color) {
    case BodyColor::speed: {
      // The map ends at 2.2 times the root mean square (weighted by mass). Equal speeds lie in its middle,
      // and a few fast bodies do not compress the colours. The legend marks clipped values.
      const double rms = scene.total_mass > 0 ? std::sqrt(2 * stats.kinetic_energy / scene.total_mass) : 0;
      return {0, rounded_up_to_digits(2.2 * rms)};
    }
    case BodyColor::radius:
      return {0, rounded_up_to_digits(scene.largest_radius)};
    case BodyColor::contacts:
      return {0, 12};  // maximum number of equal spheres that touch one sphere
    case BodyColor::id:
    case BodyColor::order:
      return {0, static_cast<double>(std::max<std::int64_t>(scene.body_count, 2) - 1)};
    case BodyColor::depth:
      return world.tree().nodes() > 0 ? leaf_levels(world) : ValueRange{0, 0};
    case BodyColor::sleep:
      return {0, 1};
    case BodyColor::error: {  // three decades, up to the 98th percentile
      const double most = quantile(world.publisher().errors(), 0.98);
      const double high = most > 0 ? std::pow(10, std::ceil(std::log10(most))) : 1;
      ValueRange range{high / 1000, high};
      range.logarithmic = true;
      return range;
    }
    case BodyColor::visits: {
      if (world.tree().nodes() == 0) return {0, 0};
      const TreeQuality& tree = world.tree().quality();
      ValueRange range{static_cast<double>(tree.visits_min), static_cast<double>(tree.visits_max)};
      range.logarithmic = true;
      return range;
    }
  }
  return {};
}

// Lower edge of the first bin with more than 2 % of the nodes at or below it.
double low_end(const NodeHistogram& histogram) {
  std::int64_t below = 0;
  std::size_t bin = 0;
  for (; bin + 1 < NodeHistogram::bins; ++bin) {
    below += histogram.nodes[bin];
    if (50 * below > histogram.count) break;
  }
  return static_cast<double>(histogram.edge[bin]);
}

void add_boxes(World& world, const FrameLayers& layers, ValueRange& range) {
  if (!layers.boxes || layers.box_color == NodeMetric::level || world.tree().nodes() == 0) return;
  const NodeHistogram histogram = world.tree().node_histogram(
      layers.box_color, {layers.first_level, layers.last_level, layers.box_low, layers.box_high});
  range.boxes = histogram.inside;
  range.box_max = static_cast<double>(std::min(layers.box_high, histogram.greatest));
  // A few boxes with tiny values must not compress the colours.
  const double least = static_cast<double>(std::max(layers.box_low, histogram.least));
  range.box_min = std::max(least, low_end(histogram));
  if (is_logarithmic(layers.box_color))  // a logarithmic scale needs a positive minimum
    range.box_min = std::max(range.box_min, 1e-9 * range.box_max);
  range.box_min = std::min(range.box_min, range.box_max);
  range.boxes_below = range.box_min > least;
}

}  // namespace

double automatic_error_scale(const std::vector<float>& errors, double body_size, double scene_size) {
  double most = 0;
  for (const float error : errors)
    if (std::isfinite(error)) most = std::max(most, static_cast<double>(error));
  const double error = quantile(errors, 0.9);
  double scale = error > 0 ? 2 * body_size / error : 1;
  if (most > 0) scale = std::min(scale, 0.25 * scene_size / most);
  return std::pow(10, std::clamp(std::floor(std::log10(scale)), 0.0, 9.0));
}

ValueRange value_range(World& world, const FrameScene& scene, const FrameLayers& layers,
                       const StepStats& stats) {
  ValueRange range = layers.spheres ? color_range(world, scene, layers.color, stats) : ValueRange{};
  add_boxes(world, layers, range);
  if (layers.errors)
    range.error_scale =
        layers.error_scale > 0
            ? layers.error_scale
            : automatic_error_scale(world.publisher().errors(), scene.body_size, scene.bounds.diagonal());
  if (stats.max_impulse > 0) range.max_impulse = rounded_up_to_digits(stats.max_impulse);
  return range;
}

}  // namespace collidoscope

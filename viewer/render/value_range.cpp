#include "viewer/render/value_range.h"

#include <algorithm>
#include <cmath>

namespace collidoscope {
namespace {

// Up to two digits, so that legends read well: 17.3 becomes 18.
double round_up(double value) {
  if (!(value > 0) || !std::isfinite(value)) return 1;
  const double unit = std::pow(10, std::floor(std::log10(value)) - 1);
  return std::ceil(value / unit - 1e-9) * unit;
}

ValueRange color_range(const FrameScene& scene, BodyColor color, const StepStats& stats) {
  switch (color) {
    case BodyColor::speed: {
      // The map ends at 2.2 times the root mean square (weighed by mass): bodies of one speed lie in its
      // middle, and a few fast ones do not leave one colour to all others. The legend says if it goes on.
      const double rms = scene.total_mass > 0 ? std::sqrt(2 * stats.kinetic_energy / scene.total_mass) : 0;
      return {0, round_up(2.2 * rms)};
    }
    case BodyColor::radius:
      return {0, round_up(scene.largest_radius)};
    case BodyColor::contacts:
      return {0, 12};  // as many equal spheres as touch one of their size
    case BodyColor::id:
    case BodyColor::order:
      return {0, static_cast<double>(std::max<std::int64_t>(scene.body_count, 2) - 1)};
  }
  return {};
}

}  // namespace

ValueRange value_range(const FrameScene& scene, BodyColor color, const StepStats& stats) {
  ValueRange range = color_range(scene, color, stats);
  if (stats.max_impulse > 0) range.max_impulse = round_up(stats.max_impulse);
  return range;
}

}  // namespace collidoscope

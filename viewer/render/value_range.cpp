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

ValueRange color_range(const World& world, BodyColor color, const StepStats& stats) {
  const std::vector<double>& radius = world.initial().radius;
  const double last = static_cast<double>(std::max<std::size_t>(radius.size(), 2) - 1);
  switch (color) {
    case BodyColor::speed: {
      // The map ends at 2.2 times the root mean square (weighed by mass): bodies of one speed lie in its
      // middle, and a few fast ones do not leave one colour to all others. The legend says if it goes on.
      double mass = 0;
      for (double m : world.initial().mass) mass += m;
      const double rms = mass > 0 ? std::sqrt(2 * stats.kinetic_energy / mass) : 0;
      return {0, round_up(2.2 * rms)};
    }
    case BodyColor::radius:
      return {0, radius.empty() ? 1 : round_up(*std::max_element(radius.begin(), radius.end()))};
    case BodyColor::contacts:
      return {0, 12};  // as many equal spheres as touch one of their size
    case BodyColor::id:
    case BodyColor::order:
      return {0, last};
  }
  return {};
}

}  // namespace

ValueRange value_range(const World& world, BodyColor color, const StepStats& stats) {
  ValueRange range = color_range(world, color, stats);
  if (stats.max_impulse > 0) range.max_impulse = round_up(stats.max_impulse);
  return range;
}

}  // namespace collidoscope

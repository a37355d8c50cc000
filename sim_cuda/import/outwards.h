#pragma once
// Conversion of a box to single precision, so that it contains the box that it was.

#include <cmath>
#include <limits>
#include <type_traits>

namespace collidoscope {

/// The nearest float that is not on the inner side of `value`. `direction`: of the outer side, -1 or 1.
template <class Number>
float rounded_outwards(Number value, float direction) {
  if constexpr (std::is_same_v<Number, float>) {
    return value;
  } else {
    const auto nearest = static_cast<float>(value);
    const auto exact = static_cast<long double>(value), rounded = static_cast<long double>(nearest);
    const bool inside = direction < 0 ? rounded > exact : rounded < exact;
    return inside ? std::nextafter(nearest, direction * std::numeric_limits<float>::infinity()) : nearest;
  }
}

}  // namespace collidoscope

#pragma once
// JSON has no NaN and no infinity. Both are written as null.

#include <cmath>
#include <nlohmann/json.hpp>

namespace collidoscope {

inline nlohmann::ordered_json finite_or_null(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

}  // namespace collidoscope

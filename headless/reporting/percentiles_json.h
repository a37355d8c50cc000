#pragma once
// Percentiles as a JSON object.

#include <nlohmann/json.hpp>

#include "headless/reporting/percentiles.h"

namespace collidoscope {

inline nlohmann::ordered_json percentiles_json(const Percentiles& s) {
  return {{"median", s.median}, {"p5", s.p5}, {"p95", s.p95}};
}

}  // namespace collidoscope

#pragma once
// A Spread as the JSON files of the suites give it.

#include <nlohmann/json.hpp>

#include "headless/reporting/spread.h"

namespace collidoscope {

inline nlohmann::ordered_json spread_json(const Spread& s) {
  return {{"median", s.median}, {"p5", s.p5}, {"p95", s.p95}};
}

}  // namespace collidoscope

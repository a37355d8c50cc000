#pragma once
// Percentiles, and estimates of ratios, as JSON objects.

#include <cmath>
#include <nlohmann/json.hpp>

#include "headless/reporting/percentiles.h"
#include "sim_cuda/core/ratio_estimate.h"

namespace collidoscope {

inline nlohmann::ordered_json percentiles_json(const Percentiles& s) {
  return {{"median", s.median}, {"p5", s.p5}, {"p95", s.p95}};
}

/// Without enough pairs, `high` is null.
inline nlohmann::ordered_json estimate_json(const RatioEstimate& estimate) {
  nlohmann::ordered_json json{
      {"ratio", estimate.ratio}, {"low", estimate.low}, {"high", nullptr}, {"pairs", estimate.pairs}};
  if (std::isfinite(estimate.high)) json["high"] = estimate.high;
  return json;
}

}  // namespace collidoscope

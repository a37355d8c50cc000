#pragma once
// How each quantity of a criterion is measured at a state. quantity_names (criterion.h) defines them. Free
// functions over an observation.
//
// `difference` and `other_hash` need other runs, `found` is 1 where guards found what they must and nothing
// else, or 0: test_run.h.

#include <cstdint>
#include <optional>

#include "sim_cuda/stability/observation.h"

namespace collidoscope {

/// Minimum and maximum over all bodies, and the bodies that have them; equal for a single number. A NaN sets
/// both permanently. Without values, both are 0.
struct Extremes {
  double min = 0, max = 0;
  std::optional<std::uint32_t> min_body{}, max_body{};
  bool any = false;

  void add(double value, std::optional<std::uint32_t> body = std::nullopt);
};

/// Measures the observed state. The quantity must not be one of the three above.
Extremes measured(const Assertion& assertion, Observation& observation);
/// Distance of each body from its counterpart in `other`, shifted by the assertion's offset.
Extremes difference(const Assertion& assertion, const BodyStates& bodies, const BodyStates& other);

/// The body that violates an assertion whose measured() reports none: penetrations, escapes and non-finite
/// bodies.
std::optional<std::uint32_t> offending_body(const Assertion& assertion, Observation& observation);

}  // namespace collidoscope

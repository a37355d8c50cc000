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

/// The least and the most of all bodies, and whose they are; the same where it is one number. A value that is
/// NaN is both, from then on. Without values, both are 0.
struct Extremes {
  double min = 0, max = 0;
  std::optional<std::uint32_t> min_body{}, max_body{};
  bool any = false;

  void add(double value, std::optional<std::uint32_t> body = std::nullopt);
};

/// Of the state that is observed; the assertion is none of those three.
Extremes measured(const Assertion& assertion, Observation& observation);
/// How far each body is from where `other` has it, and the assertion's offset.
Extremes difference(const Assertion& assertion, const BodyStates& bodies, const BodyStates& other);

/// Whose fault it is, where measured() does not say: of penetrations, escapes and what is not finite.
std::optional<std::uint32_t> offending_body(const Assertion& assertion, Observation& observation);

}  // namespace collidoscope

#include "sim_cuda/stability/criterion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace collidoscope {

std::string_view unit_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::penetration:
    case Quantity::displacement:
    case Quantity::position:
    case Quantity::joint_error:
    case Quantity::difference:
      return "m";
    case Quantity::speed:
    case Quantity::velocity:
    case Quantity::separation_speed:
      return "m/s";
    case Quantity::angular_speed:
      return "rad/s";
    case Quantity::joint_angle:
      return "rad";
    case Quantity::kinetic_energy:
      return "J";
    default:
      return "";
  }
}

std::string_view parameters_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::displacement:
      return "`body`, `since`";
    case Quantity::position:
    case Quantity::velocity:
      return "`axis`, `body`";
    case Quantity::difference:
      return "`scene`, `offset`";
    case Quantity::other_hash:
      return "`shapes` `[[B, T], ...]`, `broad_phases` (`[\"all\"]`: all methods of the executor)";
    default:
      return "";
  }
}

std::string text_of(Quantity quantity, double value) {
  const std::string_view unit = unit_of(quantity);
  const bool whole = value == std::floor(value) && std::abs(value) < 1e7;
  const std::string number = whole ? fmt::format("{:.0f}", value) : fmt::format("{:.3g}", value);
  return unit.empty() ? number : fmt::format("{} {}", number, unit);
}

namespace {

/// " at most 0.1 m".
std::string bounds_text(Quantity quantity, std::optional<double> at_most, std::optional<double> at_least) {
  const std::string_view unit = unit_of(quantity);
  const auto bound = [&](double value) {
    return fmt::format("{:g}{}{}", value, unit.empty() ? "" : " ", unit);
  };
  if (at_most && at_least && *at_most == *at_least) return " " + bound(*at_most);
  if (at_most && at_least) return fmt::format(" {} to {}", bound(*at_least), bound(*at_most));
  if (at_most) return " at most " + bound(*at_most);
  return at_least ? " at least " + bound(*at_least) : "";
}

/// "position z of body 3".
std::string name_text(const Assertion& assertion) {
  std::string text(name_of(quantity_names, assertion.quantity));
  const bool along = assertion.quantity == Quantity::position || assertion.quantity == Quantity::velocity;
  if (along) text += fmt::format(" {}", "xyz"[assertion.axis]);
  if (assertion.body) text += fmt::format(" of body {}", *assertion.body);
  return text;
}

}  // namespace

std::string text_of(const Assertion& assertion, const ExpectedFailureTerm& term) {
  return name_text(assertion) + bounds_text(assertion.quantity, term.at_most, term.at_least);
}

std::string text_of(const Assertion& assertion) {
  if (assertion.quantity == Quantity::finite) return "all finite";
  if (assertion.quantity == Quantity::expected_finding) return "guards report the expected finding";
  std::string text = name_text(assertion);
  if (assertion.since > 0) text += fmt::format(" since state {}", assertion.since);
  if (!assertion.scene.empty()) text += " from " + assertion.scene.substr(0, assertion.scene.find(".json"));
  text += bounds_text(assertion.quantity, assertion.at_most, assertion.at_least);
  if (assertion.from && assertion.to && *assertion.from == *assertion.to)
    text += fmt::format(" at state {}", *assertion.from);
  else if (assertion.from && assertion.to)
    text += fmt::format(", states {} to {}", *assertion.from, *assertion.to);
  else if (assertion.from)
    text += fmt::format(" from state {}", *assertion.from);
  else if (assertion.to)
    text += fmt::format(" up to state {}", *assertion.to);
  return text;
}

const ExpectedFailureTerm* ExpectedFailure::term_of(std::size_t assertion) const {
  const auto found = std::ranges::find(fails, assertion, &ExpectedFailureTerm::assertion);
  return found == fails.end() ? nullptr : &*found;
}

const ExpectedFailure* Criterion::expected_failure_of(Solver solver, Precision precision,
                                                      ExecutorKind executor) const {
  const auto fits = [&](const ExpectedFailure& limit) {
    return limit.solver.value_or(solver) == solver && limit.precision.value_or(precision) == precision &&
           limit.executor.value_or(executor) == executor;
  };
  const auto first = std::ranges::find_if(expected_failures, fits);
  return first == expected_failures.end() ? nullptr : &*first;
}

}  // namespace collidoscope

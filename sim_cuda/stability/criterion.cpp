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
    case Quantity::spin:
      return "rad/s";
    case Quantity::joint_angle:
      return "rad";
    case Quantity::kinetic_energy:
      return "J";
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

std::string text_of(const Term& term) {
  std::string text(name_of(quantity_names, term.quantity));
  if (term.quantity == Quantity::finite) return "all finite";
  if (term.quantity == Quantity::found) return "guards find what they must";
  const bool along = term.quantity == Quantity::position || term.quantity == Quantity::velocity;
  if (along) text += fmt::format(" {}", "xyz"[term.axis]);
  if (term.body) text += fmt::format(" of body {}", *term.body);
  if (term.since > 0) text += fmt::format(" since state {}", term.since);
  if (!term.scene.empty()) text += " from " + term.scene.substr(0, term.scene.find(".json"));
  const std::string_view unit = unit_of(term.quantity);
  const auto bound = [&](double value) {
    return fmt::format("{:g}{}{}", value, unit.empty() ? "" : " ", unit);
  };
  if (term.at_most && term.at_least && *term.at_most == *term.at_least)
    text += " " + bound(*term.at_most);
  else if (term.at_most && term.at_least)
    text += fmt::format(" {} to {}", bound(*term.at_least), bound(*term.at_most));
  else if (term.at_most)
    text += " at most " + bound(*term.at_most);
  else if (term.at_least)
    text += " at least " + bound(*term.at_least);
  if (term.from && term.to && *term.from == *term.to)
    text += fmt::format(" at state {}", *term.from);
  else if (term.from && term.to)
    text += fmt::format(", states {} to {}", *term.from, *term.to);
  else if (term.from)
    text += fmt::format(" from state {}", *term.from);
  else if (term.to)
    text += fmt::format(" up to state {}", *term.to);
  return text;
}

const DeclaredLimit* Criterion::limit_of(Solver solver, Precision precision, ExecutorKind executor) const {
  const auto fits = [&](const DeclaredLimit& limit) {
    return limit.solver.value_or(solver) == solver && limit.precision.value_or(precision) == precision &&
           limit.executor.value_or(executor) == executor;
  };
  const auto first = std::ranges::find_if(limits, fits);
  return first == limits.end() ? nullptr : &*first;
}

}  // namespace collidoscope

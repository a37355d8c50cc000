#include "sim_cuda/guard/finding.h"

#include <fmt/format.h>

namespace collidoscope {

std::string_view name_of(FindingQuantity quantity) {
  switch (quantity) {
    case FindingQuantity::box:
      return "box";
    case FindingQuantity::normal:
      return "contact normal";
    case FindingQuantity::acceleration:
      return "acceleration";
    case FindingQuantity::velocity:
      return "velocity";
    case FindingQuantity::spin:
      return "spin";
    case FindingQuantity::position:
      return "position";
    case FindingQuantity::orientation:
      return "orientation";
  }
  return "?";
}

std::string_view unit_of(FindingQuantity quantity) {
  switch (quantity) {
    case FindingQuantity::box:
    case FindingQuantity::position:
      return "m";
    case FindingQuantity::acceleration:
      return "m/s^2";
    case FindingQuantity::velocity:
      return "m/s";
    case FindingQuantity::spin:
      return "rad/s";
    case FindingQuantity::normal:
    case FindingQuantity::orientation:
      break;
  }
  return "";
}

std::string describe(const Finding& finding) {
  const std::string_view unit = unit_of(finding.quantity);
  return fmt::format(
      "stage {} of step {}, substep {}: body {} has the {} {:.6g}{}{}{}", finding.stage, finding.step,
      finding.substep, finding.body, name_of(finding.quantity), finding.value, unit.empty() ? "" : " ", unit,
      finding.invalid_before ? fmt::format("; it was already invalid in state {}", finding.step - 1) : "");
}

}  // namespace collidoscope

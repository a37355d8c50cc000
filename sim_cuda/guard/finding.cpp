#include "sim_cuda/guard/finding.h"

#include <fmt/format.h>

namespace collidoscope {

std::string_view name_of(FoundQuantity quantity) {
  switch (quantity) {
    case FoundQuantity::box:
      return "box";
    case FoundQuantity::normal:
      return "contact normal";
    case FoundQuantity::acceleration:
      return "acceleration";
    case FoundQuantity::velocity:
      return "velocity";
    case FoundQuantity::spin:
      return "spin";
    case FoundQuantity::position:
      return "position";
    case FoundQuantity::orientation:
      return "orientation";
  }
  return "?";
}

std::string_view unit_of(FoundQuantity quantity) {
  switch (quantity) {
    case FoundQuantity::box:
    case FoundQuantity::position:
      return "m";
    case FoundQuantity::acceleration:
      return "m/s^2";
    case FoundQuantity::velocity:
      return "m/s";
    case FoundQuantity::spin:
      return "rad/s";
    case FoundQuantity::normal:
    case FoundQuantity::orientation:
      break;
  }
  return "";
}

std::string describe(const Finding& finding) {
  const std::string_view unit = unit_of(finding.quantity);
  return fmt::format("stage {} of step {}, substep {}: body {} has the {} {:.6g}{}{}{}", finding.stage,
                     finding.step, finding.substep, finding.body, name_of(finding.quantity), finding.value,
                     unit.empty() ? "" : " ", unit,
                     finding.before ? fmt::format("; it was bad in state {} already", finding.step - 1) : "");
}

}  // namespace collidoscope

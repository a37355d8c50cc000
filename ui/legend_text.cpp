#include "ui/legend_text.h"

#include <fmt/format.h>

#include <cmath>

#include "ui/widgets.h"

namespace collidoscope {
namespace {

std::string number(double value) {
  return std::abs(value) >= 1e4 && value == std::floor(value)
             ? grouped_number(static_cast<std::int64_t>(value))
             : fmt::format("{:.4g}", value);
}

}  // namespace

std::string title_text(const Legend& legend) {
  std::string text = legend.title;
  if (!legend.unit.empty()) text += " · " + legend.unit;
  if (legend.logarithmic) text += " · log";
  return text;
}

std::string low_text(const Legend& legend) {
  if (!legend.low_word.empty()) return legend.low_word;
  return (legend.clamped_below ? "≤ " : "") + number(legend.min);
}
std::string high_text(const Legend& legend) {
  if (!legend.high_word.empty()) return legend.high_word;
  return (legend.clamped_above ? "≥ " : "") + number(legend.max);
}

}  // namespace collidoscope

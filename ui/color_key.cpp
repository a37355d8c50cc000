#include "ui/color_key.h"

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

std::string title_text(const Legend& key) {
  std::string text = key.title;
  if (!key.unit.empty()) text += " · " + key.unit;
  if (key.logarithmic) text += " · log";
  return text;
}

std::string low_text(const Legend& key) {
  if (!key.low_word.empty()) return key.low_word;
  return (key.goes_below ? "≤ " : "") + number(key.min);
}
std::string high_text(const Legend& key) {
  if (!key.high_word.empty()) return key.high_word;
  return (key.goes_on ? "≥ " : "") + number(key.max);
}

}  // namespace collidoscope

#include "headless/cli/flag_value.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace collidoscope {
namespace {

/// The whole text as one number, or nothing. Knows no locale, no leading blank and no trailing word.
template <class Number>
std::optional<Number> parse(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

std::string shown(std::string_view text) {
  constexpr std::size_t longest = 200;  // bytes: a line of a terminal or two
  return text.empty() ? "''" : printable(text, longest);
}

void FlagValue::fault(std::string_view what) { faults_->push_back(fmt::format("{}: {}", flag_, what)); }

void FlagValue::refuse(std::string_view right) { fault(fmt::format("{} is not {}", shown(text_), right)); }

std::optional<std::int64_t> FlagValue::whole(std::int64_t min, std::int64_t max, std::string_view or_word) {
  const auto number = parse<std::int64_t>(text_);
  if (number && *number >= min && *number <= max) return number;
  refuse(fmt::format("a whole number from {} to {}{}", min, max, or_word));
  return std::nullopt;
}

std::optional<std::uint64_t> FlagValue::whole_u64() {
  const auto number = parse<std::uint64_t>(text_);
  if (!number) refuse(fmt::format("a whole number from 0 to {}", UINT64_MAX));
  return number;
}

std::optional<double> FlagValue::number(double min, double max, std::string_view unit,
                                        std::string_view or_word) {
  const auto number = parse<double>(text_);
  if (number && std::isfinite(*number) && *number >= min && *number <= max) return number;
  refuse(fmt::format("a number from {} to {}{}{}{}", min, max, unit.empty() ? "" : " ", unit, or_word));
  return std::nullopt;
}

std::vector<FlagValue> FlagValue::parts() const {
  std::vector<FlagValue> all;
  for (std::size_t from = 0, comma = 0; comma != std::string_view::npos; from = comma + 1) {
    comma = text_.find(',', from);
    all.push_back(part(text_.substr(from, comma - from)));
  }
  return all;
}

std::optional<Vector3d> FlagValue::vector(double limit, std::string_view unit) {
  Vector3d result = Vector3d::Zero();
  const std::vector<FlagValue> components = parts();
  bool good = components.size() == 3;
  for (int axis = 0; good && axis < 3; ++axis) {
    const auto number = parse<double>(components[axis].text());
    good = number && std::abs(*number) <= limit;
    if (good) result[axis] = *number;
  }
  if (good) return result;
  refuse(fmt::format("x,y,z: three numbers from {} to {} {}", -limit, limit, unit));
  return std::nullopt;
}

std::optional<std::string> FlagValue::word(std::span<const std::string> words, std::string_view what) {
  if (std::ranges::find(words, text_) != words.end()) return std::string(text_);
  unknown(std::vector<std::string_view>(words.begin(), words.end()), what);
  return std::nullopt;
}

void FlagValue::unknown(std::span<const std::string_view> names, std::string_view what) {
  if (what.empty()) what = flag_.substr(flag_.find_first_not_of('-'));
  fault(unknown_name(what, text_, names));
}

}  // namespace collidoscope

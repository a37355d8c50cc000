#pragma once
// The cells of a field: its range, its default and its meaning. For sources only: it includes nlohmann's
// library.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "headless/markdown/cells.h"
#include "sim_cuda/scene/field.h"
#include "sim_cuda/scene/field_json.h"

namespace collidoscope {
namespace detail {

template <class Value>
struct Plain {
  using Type = Value;
};
template <class Value>
struct Plain<std::optional<Value>> {
  using Type = Value;
};

template <class Value>
inline constexpr bool is_whole = std::is_integral_v<Value> && !std::is_same_v<Value, bool>;

/// "0 to 10⁹", "±10⁶".
inline std::string bounds_text(double low, double high) {
  return low == -high ? "±" + number_text(high) : number_text(low) + " to " + number_text(high);
}

/// A value of JSON in Markdown.
inline std::string json_cell(const nlohmann::ordered_json& value) {
  if (value.is_number()) return number_text(value.get<double>());
  if (!value.is_array()) return code(value.dump());
  std::string text = "[";
  for (const nlohmann::ordered_json& part : value) text += (text.size() > 1 ? ", " : "") + json_cell(part);
  return text + "]";
}

}  // namespace detail

/// Its choices as a file has them: `"a"`, `"b"`.
template <auto member>
std::string choices_text(const Field<member>& field) {
  std::string text;
  for (const auto& choice : field.choices) {
    const bool is_number = !std::is_enum_v<typename Field<member>::Value> && choice.name != "auto";
    text += (text.empty() ? "" : ", ") +
            code(is_number ? std::string(choice.name) : fmt::format("\"{}\"", choice.name));
  }
  return text;
}

/// What can be given for it; its bounds with the unit, if one is given.
template <auto member>
std::string range_text(const Field<member>& field, std::string_view unit = "") {
  using Value = typename detail::Plain<typename Field<member>::Value>::Type;
  if constexpr (std::is_same_v<Value, Effects>) {
    return "`\"auto\"` or a list of effects";
  } else if constexpr (std::is_same_v<Value, bool>) {
    return "`true`, `false`";
  } else if constexpr (std::is_same_v<Value, std::string>) {
    return field.words == nullptr ? "text" : "name of a method";
  } else if constexpr (std::is_same_v<Value, std::uint64_t>) {
    return "whole, 0 to 2⁶⁴ − 1";
  } else {
    if (!field.choices.empty()) return choices_text(field);
    if (field.low == field.high) return detail::is_whole<Value> ? "whole, 0 or more" : "not 0";
    std::string text = detail::bounds_text(field.low, field.high);
    if (!unit.empty()) text += " " + unit_text(unit);
    if constexpr (detail::is_whole<Value>) text = "whole, " + text;
    if constexpr (std::is_same_v<Value, Vector3d>) text += " per component";
    if constexpr (std::is_same_v<Value, std::array<double, 2>>) text += " each";
    if (field.automatic != Auto::none) text += ", or `\"auto\"`";
    return text;
  }
}

/// Its value in a new owner, or what stands for it.
template <auto member>
std::string default_text(const Field<member>& field) {
  if (!field.fallback.empty()) return prose(field.fallback);
  const typename Field<member>::Value value = typename Field<member>::Owner{}.*member;
  if constexpr (std::is_same_v<typename Field<member>::Value, TimeStep>) {
    const double rate = 1 / value.seconds();
    if (rate == std::round(rate)) return "1/" + number_text(rate);
  }
  return detail::json_cell(value_json(field, value));
}

/// "`library`: CUB's, or the CPU's. `radix`: ..." of the choices that have a help.
template <auto member>
std::string choices_help(const Field<member>& field) {
  std::string text;
  for (const auto& choice : field.choices)
    if (!choice.help.empty())
      text += fmt::format("{}{}: {}", text.empty() ? "" : ". ", code(choice.name), prose(choice.help));
  return text;
}

/// Its help and that of its choices.
template <auto member>
std::string meaning_text(const Field<member>& field) {
  const std::string choices = choices_help(field);
  return prose(field.help) + (field.help.empty() || choices.empty() ? "" : ". ") + choices;
}

}  // namespace collidoscope

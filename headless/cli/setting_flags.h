#pragma once
// The flags of settings: each row of sim_cuda/scene/settings.h that can be given on a command line.

#include <optional>
#include <string_view>
#include <type_traits>

#include "headless/cli/flag_value.h"
#include "sim_cuda/scene/settings.h"

namespace collidoscope {

/// S, or 1/n.
std::optional<TimeStep> parse_time_step(FlagValue& value);
/// auto, none, or a list of names with commas between them.
std::optional<std::optional<Effects>> parse_effects(FlagValue& value);

/// Whether a command line can give it.
template <auto member>
constexpr bool has_flag(const Field<member>& setting) {
  return !is_physical(setting) || setting.live != Live::never;
}

/// "impulse, soft_step or jacobi_split: contact solver".
template <auto member>
std::string help_of_flag(const Field<member>& setting) {
  using Value = typename Field<member>::Value;
  std::string help(setting.help);
  if constexpr (std::is_same_v<Value, TimeStep>) {
    help += " in seconds, or 1/n";
  } else if constexpr (std::is_same_v<Value, std::optional<Effects>>) {
    help += "; none; or a list such as gravity,rotation";
  } else {
    if (setting.automatic != Auto::none && help.find("auto") == std::string::npos) help += ", or auto";
  }
  if (!setting.choices.empty()) help = either_of(choice_names(setting)) + ": " + help;
  if (!setting.unit.empty() && setting.unit != "bytes" && setting.unit != "s")
    help = std::string(setting.unit) + ": " + help;
  return help;
}

/// The value of a flag; unset if it has a fault, which `value` has noted.
template <auto member>
std::optional<typename Field<member>::Value> parse_setting(FlagValue& value, const Field<member>& setting) {
  using Value = typename Field<member>::Value;
  constexpr std::string_view or_auto = ", or auto";
  const bool is_auto = setting.automatic != Auto::none && value.text() == "auto";
  const auto low = static_cast<std::int64_t>(setting.low), high = static_cast<std::int64_t>(setting.high);
  const std::string_view or_word = setting.automatic != Auto::none ? or_auto : "";
  if constexpr (std::is_same_v<Value, TimeStep>) {
    return parse_time_step(value);
  } else if constexpr (std::is_same_v<Value, std::optional<Effects>>) {
    return parse_effects(value);
  } else if constexpr (std::is_enum_v<Value>) {
    return value.one_of(setting.choices);
  } else if constexpr (std::is_same_v<Value, Vector3d>) {
    return value.vector(setting.high, setting.unit);
  } else if constexpr (std::is_same_v<Value, std::uint64_t>) {
    return value.whole_u64();
  } else if constexpr (std::is_same_v<Value, std::string>) {
    return value.word(setting.words());
  } else if constexpr (std::is_same_v<Value, double>) {
    return value.number(setting.low, setting.high, setting.unit);
  } else if constexpr (std::is_same_v<Value, std::optional<double>>) {
    if (is_auto) return Value{};
    const auto number = value.number(setting.low, setting.high, setting.unit, or_word);
    return number ? std::optional(Value(*number)) : std::nullopt;
  } else if constexpr (std::is_same_v<Value, std::optional<int>>) {
    if (is_auto) return Value{};
    const auto number = value.whole(low, high, or_word);
    return number ? std::optional(Value(static_cast<int>(*number))) : std::nullopt;
  } else {
    if constexpr (std::is_same_v<Value, int>)
      if (!setting.choices.empty()) return value.one_of(setting.choices);
    if (is_auto) return Value{0};
    const auto number = value.whole(low, high, or_word);
    return number ? std::optional(static_cast<Value>(*number)) : std::nullopt;
  }
}

}  // namespace collidoscope

#pragma once
// Flags of settings: their help, and how they are read. Included by flags.cpp alone.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <string>

#include "headless/cli/flag_value.h"
#include "headless/cli/options.h"
#include "sim_cuda/plugin/library.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/scene/settings.h"

namespace collidoscope {

/// S, or 1/n.
inline std::optional<TimeStep> parse_time_step(FlagValue& value) {
  if (!value.text().starts_with("1/")) {
    const auto seconds = value.number(limits::min_time_step, limits::max_time_step, "s", ", or 1/n");
    return seconds ? std::optional(TimeStep(*seconds)) : std::nullopt;
  }
  FlagValue rate = value.part(value.text().substr(2));
  const auto n = rate.whole(1, limits::max_steps_per_second);
  return n ? std::optional(TimeStep::per_second(static_cast<int>(*n))) : std::nullopt;
}

/// The name of a broad phase, or the path of a plug-in, which load_plugins() replaces by its name.
inline std::optional<std::string> broad_phase_or_plugin(FlagValue& value) {
  if (is_plugin_path(value.text())) return std::string(value.text());
  return value.word(broad_phase_names());
}

/// auto, none, or a list of names with commas.
inline std::optional<std::optional<Effects>> parse_effects(FlagValue& value) {
  if (value.text() == "auto") return std::optional<Effects>{};
  Effects effects;
  if (value.text() == "none") return std::optional{effects};
  for (const FlagValue& part : value.parts()) {
    const auto* known = std::ranges::find(effect_names, part.text(), &EffectName::name);
    if (known == effect_names.end()) {
      value.refuse(fmt::format("auto, none, or a list of {}", fmt::join(names_in(effect_names), ",")));
      return std::nullopt;
    }
    effects.*(known->flag) = true;
  }
  return std::optional{effects};
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

/// The value of a setting's flag; unset if it has a fault, which `value` has noted.
template <auto member>
std::optional<typename Field<member>::Value> parse_setting(FlagValue& value, const Field<member>& setting) {
  using Value = typename Field<member>::Value;
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
    if constexpr (is_field<member, &RunOptions::broad_phase>) return broad_phase_or_plugin(value);
    return value.word(setting.words());
  } else {
    if constexpr (std::is_same_v<Value, int>)
      if (!setting.choices.empty()) return value.one_of(setting.choices);
    const bool has_auto = setting.automatic != Auto::none;
    if (has_auto && value.text() == "auto") return Value{};
    const std::string_view or_word = has_auto ? ", or auto" : "";
    const auto number = [&] {
      if constexpr (std::is_same_v<Value, double> || std::is_same_v<Value, std::optional<double>>)
        return value.number(setting.low, setting.high, setting.unit, or_word);
      else
        return value.whole(static_cast<std::int64_t>(setting.low), static_cast<std::int64_t>(setting.high),
                           or_word);
    }();
    using Number = std::conditional_t<std::is_same_v<Value, std::optional<int>>, int, Value>;
    return number ? std::optional<Value>(static_cast<Number>(*number)) : std::nullopt;
  }
}

/// Flag::read of a setting.
template <auto member>
void read_setting(FlagValue& value, Options& options) {
  auto parsed = parse_setting(value, field_of<member>);
  if constexpr (is_physical(Field<member>{})) {
    options.overrides.settings.get<member>() = std::move(parsed);
  } else if (parsed) {
    if constexpr (std::is_same_v<typename Field<member>::Owner, LaunchShape>)
      options.run.shape.*member = *parsed;
    else
      options.run.*member = *parsed;
  }
}

}  // namespace collidoscope

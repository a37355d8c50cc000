#include "headless/cli/setting_flags.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace collidoscope {

std::optional<TimeStep> parse_time_step(FlagValue& value) {
  if (!value.text().starts_with("1/")) {
    const auto seconds = value.number(limits::min_time_step, limits::max_time_step, "s", ", or 1/n");
    return seconds ? std::optional(TimeStep(*seconds)) : std::nullopt;
  }
  FlagValue rate = value.part(value.text().substr(2));
  const auto n = rate.whole(1, limits::max_steps_per_second);
  return n ? std::optional(TimeStep::per_second(static_cast<int>(*n))) : std::nullopt;
}

std::optional<std::optional<Effects>> parse_effects(FlagValue& value) {
  if (value.text() == "auto") return std::optional<Effects>{};
  Effects effects;
  std::string_view rest = value.text() == "none" ? "" : value.text();
  bool more = value.text() != "none";
  while (more) {
    const std::size_t comma = rest.find(',');
    const auto* known = std::ranges::find(effect_names, rest.substr(0, comma), &EffectName::name);
    if (known == effect_names.end()) {
      value.refuse(fmt::format("auto, none, or a list of {}", fmt::join(names_in(effect_names), ",")));
      return std::nullopt;
    }
    effects.*(known->flag) = true;
    more = comma != std::string_view::npos;
    if (more) rest.remove_prefix(comma + 1);
  }
  return std::optional<Effects>{effects};
}

}  // namespace collidoscope

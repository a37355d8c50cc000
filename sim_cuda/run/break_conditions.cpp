#include "sim_cuda/run/break_conditions.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include "sim_cuda/core/error.h"

namespace collidoscope {
namespace {

std::string shape_of(const ConditionName& name) {
  return name.has_limit ? fmt::format("{}={}", name.name, name.unit) : std::string(name.name);
}

std::string all_shapes() {
  std::vector<std::string> shapes;
  for (const ConditionName& name : condition_names) shapes.push_back(shape_of(name));
  return fmt::format("{}", fmt::join(shapes, ", "));
}

/// What is wrong with one part of a list; empty: nothing.
std::string read_condition(std::string_view part, BreakConditions& conditions) {
  const std::size_t equals = part.find('=');
  const auto* known = std::ranges::find(condition_names, part.substr(0, equals), &ConditionName::name);
  if (known == condition_names.end())
    return fmt::format("'{}' is no condition; it is a list of {}", part, all_shapes());
  std::optional<double>& limit = conditions.limit(known->condition);
  if (limit) return fmt::format("{} is given twice; once is enough", known->name);
  limit = 0;
  if (!known->has_limit)
    return equals == part.npos ? "" : fmt::format("'{}': {} takes no number", part, known->name);
  const std::string_view text = equals == part.npos ? "" : part.substr(equals + 1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *limit);
  if (!text.empty() && error == std::errc{} && end == text.data() + text.size() && *limit >= 0 &&
      *limit <= known->max_limit)
    return "";
  return fmt::format("'{}': {}, a number from 0 to {:g}", part, shape_of(*known), known->max_limit);
}

double energy_of(const StepStats& stats) { return stats.energy() - stats.push_work; }

const StageTime* slowest(const RunTimes& times) {
  const auto stage = std::ranges::max_element(times.stages, {}, &StageTime::last_ms);
  return stage == times.stages.end() ? nullptr : &*stage;
}

}  // namespace

BreakConditions parse_break_conditions(const std::string& list) {
  BreakConditions conditions;
  std::vector<std::string> faults;
  std::string_view rest = list;
  for (bool more = true; more;) {
    const std::size_t comma = rest.find(',');
    const std::string fault = read_condition(rest.substr(0, comma), conditions);
    if (!fault.empty()) faults.push_back("--break: " + fault);
    more = comma != rest.npos;
    if (more) rest.remove_prefix(comma + 1);
  }
  if (!faults.empty()) throw InputError(faults);
  return conditions;
}

BreakWatch::BreakWatch(const StepStats& start)
    : energy_(energy_of(start)), potential_(start.potential_energy), scale_(start.kinetic_energy) {}

std::optional<Broken> BreakWatch::look(const BreakConditions& conditions, const StepStats& stats,
                                       const RunTimes& times) {
  scale_ = std::max(scale_, stats.kinetic_energy + std::abs(stats.potential_energy - potential_));
  const double rise = energy_of(stats) - energy_;
  const StageTime* stage = slowest(times);
  const auto value_of = [&](Condition condition) {
    switch (condition) {
      case Condition::non_finite:
        return static_cast<double>(stats.non_finite);
      case Condition::energy_rise:
        return rise <= 0 ? 0.0 : 100 * rise / scale_;
      case Condition::penetration:
        return stats.max_penetration;
      case Condition::speed:
        return stats.max_speed;
      case Condition::stage_ms:
        return stage != nullptr && stats.step % 2 == 0 ? stage->last_ms : 0.0;
      case Condition::escaped:
        return static_cast<double>(stats.escaped);
    }
    return 0.0;
  };
  for (const ConditionName& name : condition_names) {
    const std::optional<double>& limit = conditions.limits[static_cast<std::size_t>(name.condition)];
    if (!limit) continue;
    const double value = value_of(name.condition);
    if (value <= *limit) continue;
    return Broken{name.condition, stats.step, name.condition == Condition::stage_ms ? stage->name : "",
                  value,          *limit,     {}};
  }
  return std::nullopt;
}

void BreakWatch::change(const StepStats& before, const StepStats& after) {
  energy_ += energy_of(after) - energy_of(before);
  potential_ += after.potential_energy - before.potential_energy;
}

std::string describe(const Broken& broken) {
  const ConditionName& name = name_of(broken.condition);
  if (!broken.stage.empty())
    return fmt::format("{}: stage {} of step {} took {:.4g} ms, over {:g} ms", name.name, broken.stage,
                       broken.step, broken.value, broken.limit);
  const std::string when = broken.step > 0 ? fmt::format("after step {}", broken.step) : "at state 0";
  const std::string who = broken.body ? fmt::format(", body {}", *broken.body) : "";
  if (!name.has_limit)
    return fmt::format("{}: {} {:.0f} {}{}", name.name, when, broken.value, name.unit,
                       broken.body ? fmt::format(", the first is body {}", *broken.body) : "");
  return fmt::format("{}: {} {:.6g} {}, over {:g} {}{}", name.name, when, broken.value, name.unit,
                     broken.limit, name.unit, who);
}

}  // namespace collidoscope

#include "sim_cuda/run/break_conditions.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include "sim_cuda/core/error.h"

namespace collidoscope {
namespace {

std::string shape_of(const BreakConditionName& name) {
  return name.has_limit ? fmt::format("{}={}", name.name, name.unit) : std::string(name.name);
}

std::string all_shapes() {
  std::vector<std::string> shapes;
  for (const BreakConditionName& name : break_condition_names) shapes.push_back(shape_of(name));
  return fmt::format("{}", fmt::join(shapes, ", "));
}

/// Reads one part of a list. Returns the error, or an empty string.
std::string read_condition(std::string_view part, BreakConditions& conditions) {
  const std::size_t equals = part.find('=');
  const auto* known =
      std::ranges::find(break_condition_names, part.substr(0, equals), &BreakConditionName::name);
  if (known == break_condition_names.end())
    return fmt::format("'{}' is not a condition; expected a list of {}", part, all_shapes());
  std::optional<double>& limit = conditions.limit(known->condition);
  if (limit) return fmt::format("{} is given twice; give it once", known->name);
  limit = 0;
  if (!known->has_limit)
    return equals == part.npos ? "" : fmt::format("'{}': {} takes no number", part, known->name);
  const std::string_view text = equals == part.npos ? "" : part.substr(equals + 1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *limit);
  if (!text.empty() && error == std::errc{} && end == text.data() + text.size() && *limit >= 0 &&
      *limit <= known->max_limit)
    return "";
  return fmt::format("'{}': expected {}, a number from 0 to {:g}", part, shape_of(*known), known->max_limit);
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

BreakpointMonitor::BreakpointMonitor(const StepStats& start)
    : energy_(energy_of(start)), potential_(start.potential_energy), scale_(start.kinetic_energy) {}

std::optional<BreakpointHit> BreakpointMonitor::check(const BreakConditions& conditions,
                                                      const StepStats& stats, const RunTimes& times) {
  scale_ = std::max(scale_, stats.kinetic_energy + std::abs(stats.potential_energy - potential_));
  const double rise = energy_of(stats) - energy_;
  const StageTime* stage = slowest(times);
  const auto value_of = [&](BreakCondition condition) {
    switch (condition) {
      case BreakCondition::non_finite:
        return static_cast<double>(stats.non_finite);
      case BreakCondition::energy_rise:
        return rise <= 0 ? 0.0 : 100 * rise / scale_;
      case BreakCondition::penetration:
        return stats.max_penetration;
      case BreakCondition::speed:
        return stats.max_speed;
      case BreakCondition::stage_ms:
        return stage != nullptr && stats.step % 2 == 0 ? stage->last_ms : 0.0;
      case BreakCondition::escaped:
        return static_cast<double>(stats.escaped);
    }
    return 0.0;
  };
  for (const BreakConditionName& name : break_condition_names) {
    const std::optional<double>& limit = conditions.limits[static_cast<std::size_t>(name.condition)];
    if (!limit) continue;
    const double value = value_of(name.condition);
    if (value <= *limit) continue;
    return BreakpointHit{
        name.condition, stats.step, name.condition == BreakCondition::stage_ms ? stage->name : "",
        value,          *limit,     {}};
  }
  return std::nullopt;
}

void BreakpointMonitor::change(const StepStats& before, const StepStats& after) {
  energy_ += energy_of(after) - energy_of(before);
  potential_ += after.potential_energy - before.potential_energy;
}

std::string describe(const BreakpointHit& hit) {
  const BreakConditionName& name = name_of(hit.condition);
  if (!hit.stage.empty())
    return fmt::format("{}: stage {} of step {} took {:.4g} ms, over {:g} ms", name.name, hit.stage, hit.step,
                       hit.value, hit.limit);
  const std::string when = hit.step > 0 ? fmt::format("after step {}", hit.step) : "at state 0";
  const std::string who = hit.body ? fmt::format(", body {}", *hit.body) : "";
  if (!name.has_limit)
    return fmt::format("{}: {} {:.0f} {}{}", name.name, when, hit.value, name.unit,
                       hit.body ? fmt::format(", the first is body {}", *hit.body) : "");
  return fmt::format("{}: {} {:.6g} {}, over {:g} {}{}", name.name, when, hit.value, name.unit, hit.limit,
                     name.unit, who);
}

}  // namespace collidoscope

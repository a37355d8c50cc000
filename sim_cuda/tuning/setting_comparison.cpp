#include "sim_cuda/tuning/setting_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "sim_cuda/accuracy/study.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/wall_clock.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/scene/scene_file.h"
#include "sim_cuda/tuning/paired_steps.h"

namespace collidoscope {
namespace {

using Clock = PairedSteps::Clock;
constexpr int fewest_pairs = 6;  // a confidence of 95 % needs them
constexpr int most_pairs = 41;
/// Share of the budget for the errors, if there are any.
constexpr double error_share = 0.5;

/// Collects the choices of one axis.
class Choices {
 public:
  Choices(const World& world, std::string axis, std::vector<SettingChoice>& all)
      : world_(world), axis_(std::move(axis)), all_(all) {}

  const World& world() const { return world_; }
  /// Adds a value of an option, unless it is `now`.
  template <class Owner, class Value>
  void add(Value Owner::*option, std::string_view name, const Value& value, const Value& now) {
    if (value == now) return;
    all_.push_back({axis_, std::string(name), world_.scene(), world_.options(), true});
    all_.back().options.*option = value;
  }
  template <class Owner, class Value, class Table>
  void add_all(Value Owner::*option, const Table& table) {
    for (const auto& one : table) add(option, one.name, one.value, world_.options().*option);
  }
  /// The same for a physical setting.
  template <class Owner, class Member, class Value>
  void add_physical(Member Owner::*setting, std::string_view name, const Value& value, const Value& now) {
    if (value == now) return;
    all_.push_back({axis_, std::string(name), world_.scene(), world_.options(), false});
    all_.back().scene.physics.*setting = value;
  }
  template <class Owner, class Value, class Table>
  void add_all_physical(Value Owner::*setting, const Table& table) {
    for (const auto& one : table) add_physical(setting, one.name, one.value, world_.scene().physics.*setting);
  }

 private:
  const World& world_;
  std::string axis_;
  std::vector<SettingChoice>& all_;
};

bool sorts_by_key(const World& world) { return has_morton_keys(world.options().broad_phase); }

struct Axis {
  const char* name;
  void (*add)(Choices& choices);
};

constexpr Axis all_axes[] = {
    {"broad-phase",
     [](Choices& choices) {
       const ExecutorKind kind = choices.world().info().on_gpu ? ExecutorKind::cuda : ExecutorKind::cpu;
       for (const std::string& name : broad_phase_names(kind))
         choices.add(&RunOptions::broad_phase, name, name, choices.world().options().broad_phase);
     }},
    {"key-bits",
     [](Choices& choices) {
       if (sorts_by_key(choices.world())) choices.add_all(&RunOptions::key_bits, key_bits_names);
     }},
    {"sort",
     [](Choices& choices) {
       if (sorts_by_key(choices.world())) choices.add_all(&RunOptions::sort, sort_names);
     }},
    {"cpu-threads",
     [](Choices& choices) {
       const World& world = choices.world();
       if (world.info().on_gpu) return;
       const int most = static_cast<int>(std::thread::hardware_concurrency());
       const int now = world.options().cpu_threads > 0 ? world.options().cpu_threads : most;
       for (int threads = 1; threads <= std::max(most, now); threads *= 2)
         choices.add(&RunOptions::cpu_threads, fmt::to_string(threads), threads, now);
     }},
    {"solver", [](Choices& choices) { choices.add_all_physical(&Physics::solver, solver_names); }},
    {"substeps",
     [](Choices& choices) {
       for (int substeps = 1; substeps <= 16; substeps *= 2)
         choices.add_physical(&Physics::substeps, fmt::to_string(substeps), substeps,
                              choices.world().substeps());
     }},
    {"iterations",
     [](Choices& choices) {
       for (int iterations = 1; iterations <= 8; iterations *= 2)
         choices.add_physical(&Physics::iterations, fmt::to_string(iterations), iterations,
                              choices.world().scene().physics.iterations);
     }},
    {"precision", [](Choices& choices) { choices.add_all_physical(&Physics::precision, precision_names); }},
};

/// "" or the first fault of the scene.
std::string fault_of(const Scene& scene) {
  const std::vector<Fault> faults = validate(scene);
  return faults.empty() ? "" : line_of(faults.front());
}

ComparedSetting compared(PairedSteps& pair, const SettingChoice& choice, Clock::time_point end,
                         std::vector<double>& reference_ms) {
  ComparedSetting row{.axis = choice.axis,
                      .value = choice.value,
                      .keeps_result = choice.keeps_result,
                      .estimate = {},
                      .unavailable_reason = fault_of(choice.scene),
                      .difference = {}};
  if (!row.unavailable_reason.empty()) return row;
  try {
    pair.replace_candidate(choice.scene, choice.options);
    std::vector<double> ratios;
    const auto note = [&](double ms, double reference) {
      ratios.push_back(ms / reference);
      reference_ms.push_back(reference);
    };
    PairedSteps::Durations durations = pair.measure(fewest_pairs, Clock::time_point::max(), note);
    if (choice.keeps_result) row.difference = pair.difference(durations);
    if (Clock::now() < end && row.difference.empty()) pair.measure(most_pairs - fewest_pairs, end, note);
    row.estimate = estimate_ratio(ratios);
  } catch (const MachineError& error) {  // too little memory, or a step would take too long
    row.unavailable_reason = error.what();
  } catch (const InputError& error) {
    row.unavailable_reason = error.what();
  }
  return row;
}

/// Sets the errors of the choices that change the result, and of the present settings. Calls `progress`
/// between two pieces of work.
void measure_errors(World& world, const std::vector<SettingChoice>& choices, Clock::time_point end,
                    SettingComparison& result, const std::function<void()>& progress) {
  std::vector<std::size_t> rows;
  std::vector<AccuracyPoint> points(1);
  const Physics& now = world.scene().physics;
  points[0].setting = accuracy_setting(now, world.substeps(), world.effects());
  for (std::size_t k = 0; k < choices.size(); ++k) {
    if (choices[k].keeps_result || !result.rows[k].unavailable_reason.empty()) continue;
    const Physics& physics = choices[k].scene.physics;
    AccuracyPoint point;
    const int substeps = physics.solver == now.solver ? physics.substeps.value_or(world.substeps())
                                                      : substeps_in_effect(physics);
    point.setting = accuracy_setting(physics, substeps, world.effects());
    point.series_name = choices[k].axis;
    point.name = choices[k].value;
    points.push_back(point);
    rows.push_back(k);
  }
  if (rows.empty()) return;
  AccuracyStudyOptions request;
  request.rounds = 1;
  request.settings = points;
  const RunState state = world.state();
  AccuracyStudy study(world.scene(), world.options(), request, &state);
  const auto error_of = [&](std::size_t point) {
    return study.points().size() > point ? study.points()[point].error : not_known;
  };
  const auto known = [&] {
    for (std::size_t k = 0; k <= rows.size(); ++k)
      if (error_of(k) != error_of(k)) return false;
    return true;
  };
  while (!known() && Clock::now() < end && study.advance(100)) progress();
  if (!known())
    result.error_unavailable = "the budget was too short for the errors; `accuracy` shows how far it is";
  result.reference_error = error_of(0);
  for (std::size_t k = 0; k < rows.size(); ++k) result.rows[rows[k]].error = error_of(k + 1);
  if (study.reference() != nullptr) result.error_resolution = study.reference()->error;
}

}  // namespace

std::vector<std::string> comparison_axes() {
  std::vector<std::string> names;
  for (const Axis& axis : all_axes) names.emplace_back(axis.name);
  return names;
}

std::vector<SettingChoice> setting_choices(const World& world, const std::vector<std::string>& axes) {
  std::vector<SettingChoice> all;
  for (const Axis& axis : all_axes) {
    if (std::ranges::find(axes, axis.name) == axes.end()) continue;
    Choices choices(world, axis.name, all);
    axis.add(choices);
  }
  return all;
}

SettingComparison compare_settings(World& world, const std::vector<SettingChoice>& choices, double budget,
                                   const std::function<void(double)>& progress) {
  const Clock::time_point start = Clock::now();
  const auto at = [&](double seconds) {
    return start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  };
  const bool with_errors = !std::ranges::all_of(choices, &SettingChoice::keeps_result);
  const double for_times = budget * (with_errors ? 1 - error_share : 1);
  SettingComparison result;
  PairedSteps pair(world);
  std::vector<double> reference_ms;
  for (std::size_t k = 0; k < choices.size(); ++k) {
    const double share = static_cast<double>(k + 1) / static_cast<double>(choices.size());
    result.rows.push_back(compared(pair, choices[k], at(for_times * share), reference_ms));
    progress(share * for_times / budget);
  }
  result.reference_ms = estimate_ratio(reference_ms).ratio;
  for (ComparedSetting& row : result.rows)
    if (row.estimate.pairs > 0) row.ms = result.reference_ms * row.estimate.ratio;
  if (with_errors) try {
      measure_errors(world, choices, at(budget), result,
                     [&] { progress(std::min(seconds_since(start) / budget, 1.0)); });
    } catch (const InputError& error) {  // no body moves
      result.error_unavailable = error.what();
    }
  result.seconds = seconds_since(start);
  return result;
}

}  // namespace collidoscope

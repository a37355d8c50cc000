#include "headless/reporting/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/measure/launch_json.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/scene/effect_reasons.h"
#include "sim_cuda/scene/field_json.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/scene/settings_patch.h"
#include "sim_cuda/world.h"

namespace collidoscope {

std::string grouped(std::int64_t number) {
  std::string digits = fmt::to_string(number);
  const std::size_t first = digits.starts_with('-') ? 1 : 0;
  for (std::size_t at = digits.size(); at > first + 3;) digits.insert(at -= 3, ",");
  return digits;
}

namespace {

using Json = nlohmann::ordered_json;

// JSON has no infinity: nlohmann writes non-finite values as null, and doubles in the shortest form that
// reads back to the same bits.
Json vector_json(const double (&v)[3]) { return Json::array({v[0], v[1], v[2]}); }

/// Null if the time was not measured.
Json time_json(double ms, int steps_timed) { return steps_timed > 0 ? Json(ms) : Json(nullptr); }

/// Writes non-finite values as words, to distinguish them from missing values (null).
Json finding_json(const Finding& finding) {
  return {
      {"stage", finding.stage},
      {"step", finding.step},
      {"substep", finding.substep},
      {"body", finding.body},
      {"quantity", name_of(finding.quantity)},
      {"value", std::isfinite(finding.value) ? Json(finding.value) : Json(fmt::format("{}", finding.value))},
      {"unit", unit_of(finding.quantity)},
      {"before", finding.invalid_before}};
}

/// All settings of the table. Those of a generator are left out unless the scene has exactly one.
Json settings_json(const RunReport& report) {
  Json json = Json::object();
  for_each_setting([&]<auto member>(const Field<member>& setting) {
    if (is_of_generator(setting) && !report.has_generator_settings) return;
    const auto& owner = owner_in<typename Field<member>::Owner>(report.settings);
    json[std::string(setting.name)] = value_json(setting, owner.*member);
  });
  return json;
}

Json pair_check_json(const RunReport& report) {
  if (!report.pair_check) return nullptr;
  const PairCheck& check = *report.pair_check;
  const BroadPhaseMethod* method = find_broad_phase(report.broad_phase);
  Json json{{"plugin", method != nullptr ? method->file : ""},
            {"compared", check.compares},
            {"runs", check.runs},
            {"wrong_runs", check.wrong_runs},
            {"missing", check.compares ? Json(check.of(PairFault::missing)) : Json(nullptr)},
            {"duplicate", check.of(PairFault::duplicate)},
            {"out_of_range", check.of(PairFault::out_of_range)},
            {"apart", check.of(PairFault::apart)},
            {"writes_beyond", check.writes_beyond},
            {"absurd_counts", check.absurd_counts},
            {"examples", Json::array()}};
  for (const FaultyPair& pair : check.examples)
    json["examples"].push_back({{"a", pair.a}, {"b", pair.b}, {"fault", name_of(pair.fault)}});
  return json;
}

std::string count_or_auto(int count) { return count == 0 ? "auto" : grouped(count); }

std::string stage_table(const RunTimes& times) {
  constexpr const char* row = "  {:<22}{:>11}{:>11}{:>9}{:>10}\n";
  constexpr const char* total_row = "  {:<22}{:>11}{:>11}\n";
  const auto ms = [](double value, int samples) { return samples > 0 ? fmt::format("{:.4f}", value) : "-"; };
  double sum = 0;
  int timed = 0;
  bool library_launch = false;
  for (const StageTime& stage : times.stages) {
    sum += stage.median_ms;
    timed += stage.samples;
    library_launch |= stage.library_launch;
  }
  std::string text = fmt::format(row, "stage", "median ms", "p95 ms", "share", "launches");
  int launches = 0;
  for (const StageTime& stage : times.stages) {
    text += fmt::format(row, stage.name + (stage.library_launch ? " *" : ""),
                        ms(stage.median_ms, stage.samples), ms(stage.p95_ms, stage.samples),
                        sum > 0 ? fmt::format("{:.1f} %", 100 * stage.median_ms / sum) : "-", stage.launches);
    launches += stage.launches;
  }
  text += fmt::format(row, "sum of the stages", ms(sum, timed), "", "", launches);
  if (times.steps_timed > 0)
    text += fmt::format(total_row, "whole step, no timers", ms(times.step_median_ms, times.steps_timed),
                        ms(times.step_p95_ms, times.steps_timed));
  text +=
      "  Stages are timed on odd steps, the whole step on even steps. The sum includes\n"
      "  the cost of the stage timers. Medians of different steps need not add up.\n";
  if (library_launch) text += "  *: partly library launch, which does not use (B, T)\n";
  return text;
}

std::string numbers_text(const RunReport& report) {
  const StepStats& first = report.initial;
  const StepStats& last = report.final;
  const auto line = [](const char* what, const std::string& value) {
    return fmt::format("  {:<18}{}\n", what, value);
  };
  const auto vector = [](const double(&v)[3], const char* unit) {
    return fmt::format("{:.6g}, {:.6g}, {:.6g} {}", v[0], v[1], v[2], unit);
  };
  std::string text = line("pairs", fmt::format("{} of overlapping boxes; {} touching", grouped(last.pairs),
                                               grouped(last.touching)));
  if (report.pair_check && report.pair_check->is_wrong())
    text += line("", "WRONG PAIRS: " + describe(*report.pair_check));
  text += line("contacts", fmt::format("{} speculative in the last step; {} mass-split",
                                       grouped(last.speculative), grouped(last.uncoloured_contacts)));
  text += line("energy", fmt::format("{:.6g} J, initially {:.6g} J", last.energy(), first.energy()));
  text += line("", fmt::format("kinetic {:.6g} J, potential {:.6g} J", last.kinetic_energy,
                               last.potential_energy + 0.0));
  text +=
      line("", fmt::format("potential energy includes push_work {:.6g} J", last.push_work - first.push_work));
  text += line("momentum", vector(last.momentum, "kg m/s"));
  text += line("angular momentum", vector(last.angular_momentum, "kg m^2/s"));
  if (!report.tuned.empty()) text += line("launch shapes", "auto, by tune: " + report.tuned);
  if (!report.tuned_rejection.empty())
    text += line("launch shapes", "auto; a result of tune is not used: " + report.tuned_rejection);
  if (last.joints > 0) {
    text += line("joints", fmt::format("{}; max error {:.3g} m, {:.3g} rad", grouped(last.joints),
                                       last.max_joint_error, last.max_joint_angle));
    if (last.spring_energy > 0) text += line("", fmt::format("{:.6g} J in springs", last.spring_energy));
  }
  if (last.can_sleep)
    text += line("asleep",
                 fmt::format("{} of {} bodies; islands {} of {}", grouped(last.asleep), grouped(last.bodies),
                             grouped(last.islands_asleep), grouped(last.islands)));
  if (!report.residuals.empty()) {
    const Residual& left = report.residuals.back();
    text += line("residual", fmt::format("{:.3g} m/s rms over {} contacts, {:.3g} m/s max", left.rms,
                                         grouped(left.contacts), left.max));
  }
  text += line("wall impulse", fmt::format("{:.6g} N s", last.wall_impulse));
  text += line("penetration", fmt::format("{:.6g} m max", last.max_penetration));
  text += line("bodies", fmt::format("{} not finite, {} outside the box", grouped(last.non_finite),
                                     grouped(last.escaped)));
  if (!report.frozen.empty())
    text += line(
        "frozen",
        fmt::format("{} bodies: {}", grouped(std::ssize(report.frozen)),
                    fmt::join(std::span(report.frozen).first(std::min<std::size_t>(report.frozen.size(), 10)),
                              ", ")));
  if (report.finding) text += line("finding", describe(*report.finding));
  text += line("memory", fmt::format("{} bytes", grouped(report.allocated_bytes)));
  if (report.wall_seconds && *report.wall_seconds > 0 && last.step > first.step) {
    text += line("time", fmt::format("{:.3f} s, {:.3g} times real time", *report.wall_seconds,
                                     report.simulated_seconds / *report.wall_seconds));
  }
  return text + line("state hash", fmt::format("{:016x}", report.state_hash));
}

}  // namespace

RunReport make_report(World& world, const StepStats& initial, std::optional<double> wall_seconds) {
  const Scene& scene = world.scene();
  // Must precede measure(), which detects contacts again.
  std::vector<Residual> residuals = world.records().residuals();
  const WorldInfo info = world.info();
  RunReport report{
      .scene = scene.name,
      .variant = {},
      .seed = {},
      .executor = info.on_gpu ? "cuda" : "cpu",
      .device = info.device_name,
      .broad_phase = world.options().broad_phase,
      .pair_check = world.pair_check(),
      .key_bits = info.key_bits,
      .solver = std::string(name_of(solver_names, scene.physics.solver)),
      .integrator = std::string(name_of(integrator_names, scene.physics.integrator)),
      .rotation_update = std::string(name_of(rotation_update_names, scene.physics.rotation_update)),
      .precision = std::string(name_of(precision_names, scene.physics.precision)),
      .effects = names_of(world.effects()),
      .effect_reasons = {},
      .settings = settings_of(scene, world.options()),
      .has_generator_settings = scene.generators.size() == 1,
      .shape = world.launch_shape(),
      .tuned = info.tuned,
      .tuned_rejection = info.tuned_rejection,
      .substeps = world.substeps(),
      .iterations = scene.physics.iterations,
      .substeps_missed = world.substeps_missed(),
      .time_step = scene.physics.time_step,
      .initial = initial,
      .final = world.measure(),
      .residuals = std::move(residuals),
      .times = world.times(),
      .state_hash = world.state_hash(),
      .allocated_bytes = world.info().allocated_bytes,
      .guards = {},
      .finding = world.validation().finding(),
      .frozen = world.validation().frozen(),
      .failure = {},
      .wall_seconds = wall_seconds};
  if (world.effects().guards)
    report.guards = name_of(on_failure_names, scene.physics.guards.value_or(ValidationSettings{}).on_failure);
  for (const EffectName& effect : effect_names)
    report.effect_reasons.emplace_back(effect.name, effect_reason(scene, world.initial(), effect.flag).why);
  report.simulated_seconds = static_cast<double>(report.final.step - initial.step) * report.time_step;
  if (!scene.generators.empty()) {
    report.variant = name_of(variant_names, scene.generators[0].variant);
    report.seed = scene.generators[0].seed;
  }
  return report;
}

nlohmann::ordered_json json_of(const RunReport& report) {
  const StepStats& last = report.final;
  Json json = Json::object();  // assigning to a null value makes nlohmann 3.11 abort when memory runs out
  json["scene"] = report.scene;
  json["variant"] = report.variant.empty() ? Json(nullptr) : Json(report.variant);
  json["seed"] = report.seed ? Json(*report.seed) : Json(nullptr);
  json["executor"] = report.executor;
  json["device"] = report.device;
  json["bodies"] = last.bodies;
  json["blocks"] = report.shape.blocks;
  json["threads"] = report.shape.threads;
  json["tuned"] = report.tuned.empty() ? Json(nullptr) : Json(report.tuned);
  json["tuned_rejection"] = report.tuned_rejection.empty() ? Json(nullptr) : Json(report.tuned_rejection);
  json["steps"] = last.step;
  json["time_step"] = report.time_step;
  json["substeps"] = report.substeps;
  json["substeps_missed"] = report.substeps_missed;
  json["iterations"] = report.iterations;
  json["broad_phase"] = report.broad_phase;
  json["pair_check"] = pair_check_json(report);
  json["key_bits"] = report.key_bits > 0 ? Json(report.key_bits) : Json(nullptr);
  json["solver"] = report.solver;
  json["integrator"] = report.integrator;
  json["rotation_update"] = report.rotation_update;
  json["precision"] = report.precision;
  json["effects"] = report.effects;
  json["effect_reasons"] = Json::object();
  for (const auto& [name, why] : report.effect_reasons) json["effect_reasons"][name] = why;
  json["settings"] = settings_json(report);
  json["physics_version"] = physics_version;
  json["state_hash"] = fmt::format("{:016x}", report.state_hash);
  json["pairs"] = {{"aabb", last.pairs},
                   {"contacts", last.touching},  // older name of "touching"
                   {"touching", last.touching},
                   {"speculative", last.speculative},
                   {"uncoloured_contacts", last.uncoloured_contacts},
                   {"bounce_cap", last.bounce_cap}};
  json["energy"] = {{"initial", report.initial.energy()},
                    {"final", last.energy()},
                    {"kinetic", last.kinetic_energy},
                    {"potential", last.potential_energy},
                    {"push_work", last.push_work}};
  json["momentum"] = vector_json(last.momentum);
  json["angular_momentum"] = vector_json(last.angular_momentum);
  json["max_penetration"] = last.max_penetration;
  json["max_speed"] = last.max_speed;
  if (last.joints > 0)
    json["joints"] = {{"count", last.joints},
                      {"max_error", last.max_joint_error},
                      {"max_angle", last.max_joint_angle},
                      {"spring_energy", last.spring_energy}};
  if (last.can_sleep)
    json["sleep"] = {{"asleep", last.asleep},
                     {"awake", last.bodies - last.asleep},
                     {"islands", last.islands},
                     {"islands_asleep", last.islands_asleep}};
  if (!report.guards.empty() || !report.frozen.empty())
    json["guards"] = {{"on_failure", report.guards.empty() ? Json(nullptr) : Json(report.guards)},
                      {"finding", report.finding ? finding_json(*report.finding) : Json(nullptr)},
                      {"frozen", report.frozen}};
  if (!report.failure.empty()) json["failure"] = report.failure;
  json["non_finite"] = last.non_finite;
  json["escaped"] = last.escaped;
  json["wall_impulse"] = last.wall_impulse;
  json["wall_impulse_vector"] = vector_json(last.wall_impulse_vector);
  if (!report.residuals.empty()) {
    json["residuals"] = Json::array();
    for (const Residual& r : report.residuals)
      json["residuals"].push_back({{"stage", r.stage},
                                   {"substep", r.substep},
                                   {"iteration", r.iteration},
                                   {"contacts", r.contacts},
                                   {"rms", r.rms},
                                   {"max", r.max}});
  }
  json["stages"] = Json::array();
  for (const StageTime& stage : report.times.stages)
    json["stages"].push_back({{"name", stage.name},
                              {"median_ms", time_json(stage.median_ms, stage.samples)},
                              {"p95_ms", time_json(stage.p95_ms, stage.samples)},
                              {"launches", stage.launches},
                              {"library_launch", stage.library_launch},
                              {"launch", launch_json(stage.launch)}});
  json["step_median_ms"] = time_json(report.times.step_median_ms, report.times.steps_timed);
  json["step_p95_ms"] = time_json(report.times.step_p95_ms, report.times.steps_timed);
  json["wall_seconds"] = report.wall_seconds ? Json(*report.wall_seconds) : Json(nullptr);
  json["allocated_bytes"] = report.allocated_bytes;
  return json;
}

std::string json_text(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string to_json(const RunReport& report) { return json_text(json_of(report)); }

std::string title_text(const RunReport& report) {
  const double rate = 1 / report.time_step;
  const std::string step = std::abs(rate - std::round(rate)) < 1e-9 * rate && rate > 1.5
                               ? fmt::format("1/{:.0f} s", rate)
                               : fmt::format("{} s", report.time_step);
  std::string text = fmt::format("{}: {} bodies{}{}; state {}, steps of {}", printable(report.scene, 200),
                                 grouped(report.final.bodies), report.variant.empty() ? "" : ", ",
                                 report.variant, grouped(report.final.step), step);
  if (report.substeps > 1) text += fmt::format(" in {} substeps", report.substeps);
  if (report.substeps_missed > 0)
    text += fmt::format(" (joints call for {:.0f}; auto gives at most {})", report.substeps_missed,
                        report.substeps);
  return text +
         fmt::format(
             "\non {} ({}), B {}, T {}\n{}{}, {}, {}, effects {}\n", report.executor, report.device,
             count_or_auto(report.shape.blocks), count_or_auto(report.shape.threads),
             report.broad_phase + (report.pair_check ? " (" + short_note_of(*report.pair_check) + ")" : ""),
             report.key_bits > 0 ? fmt::format(" with {}-bit keys", report.key_bits) : "", report.solver,
             report.precision,
             report.effects.empty() ? "none" : fmt::format("{}", fmt::join(report.effects, ",")));
}

std::string to_text(const RunReport& report) {
  std::string text = title_text(report) + "\n";
  if (!report.times.stages.empty()) text += stage_table(report.times) + "\n";
  return text + numbers_text(report);
}

}  // namespace collidoscope

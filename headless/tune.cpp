#include "headless/tune.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "headless/cli/interrupt_handler.h"
#include "headless/cli/output_file.h"
#include "headless/cli/progress.h"
#include "headless/cli/standard_output.h"
#include "headless/cli/tuned_option.h"
#include "headless/pictures/chart_picture.h"
#include "headless/reporting/percentiles_json.h"
#include "headless/tuning/launch_map.h"
#include "headless/tuning/setting_table.h"
#include "headless/tuning/tuned_run.h"
#include "headless/tuning/tuner_files.h"
#include "headless/tuning/tuner_progress.h"
#include "sim_cuda/core/cancellation.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/tuning/brute_force.h"
#include "sim_cuda/tuning/launch_tuner.h"
#include "sim_cuda/tuning/tuned_file.h"

namespace collidoscope {
namespace {

using TuneJson = nlohmann::ordered_json;

std::string text_of(const BruteForce& all, LaunchShape chosen) {
  return fmt::format("brute force over {} shapes, {:.0f} s: the best is {}: {}; {}\n", all.shapes,
                     all.seconds, shape_text(all.best),
                     verdict(all.estimate, "the chosen " + shape_text(chosen)),
                     all.agrees() ? "the search has found an optimum" : "THE SEARCH HAS MISSED IT");
}

TuneJson report_of(const World& world, const TunedRun& run, const LaunchTuner& tuner) {
  const LaunchSearch& search = tuner.search();
  TuneJson report{{"complete", true},
                  {"scene", run.scene},
                  {"bodies", run.bodies},
                  {"state", run.state},
                  {"device", run.device},
                  {"broad_phase", run.broad_phase},
                  {"plugins", plugin_notes(world.options().check_pairs)},
                  {"physics_version", run.physics_version},
                  {"reference", {{"shape", shape_text(run.reference)}, {"ms", run.reference_ms}}},
                  {"seconds", tuner.spent()}};
  report["cells"] = TuneJson::array();
  for (const LaunchCell& cell : search.cells()) {
    TuneJson one{
        {"blocks", cell.shape.blocks}, {"threads", cell.shape.threads}, {"state", name_of(cell.state)}};
    if (!cell.reason.empty()) one["reason"] = cell.reason;
    if (!cell.ratios.empty()) {
      one["ms"] = typical_ms(run, cell);
      one["ratio"] = estimate_json(cell.estimate());
    }
    report["cells"].push_back(std::move(one));
  }
  report["plateau"] = search.plateau();
  report["chosen"] = nullptr;
  const std::optional<std::size_t> chosen = search.chosen();
  if (!chosen) return report;
  const LaunchShape fastest = search.cells()[*chosen].shape;
  report["chosen"] = {{"blocks", fastest.blocks},
                      {"threads", fastest.threads},
                      {"confirmation", estimate_json(search.confirmation())},
                      {"verdict", verdict(search.confirmation(), shape_text(tuner.reference()))}};
  const StageShapes best = tuner.stage_shapes();
  report["stages"] = TuneJson::array();
  for (const LaunchTuner::Stage& stage : tuner.stages()) {
    if (!stage.obeys) continue;
    TuneJson one{
        {"name", stage.name}, {"reference_ms", stage.reference_ms}, {"chosen_ms", stage.cell_ms[*chosen]}};
    if (const auto shape = std::ranges::find(best, stage.name, &StageShape::stage); shape != best.end()) {
      one["best"] = {shape->shape.blocks, shape->shape.threads};
      one["best_ms"] = stage.reference_ms * stage.confirmation.ratio;
      one["confirmation"] = estimate_json(stage.confirmation);
    }
    report["stages"].push_back(std::move(one));
  }
  report["stage_shapes"] = {{"flag", stage_shapes_text(best)},
                            {"confirmation", estimate_json(tuner.stage_confirmation())}};
  report["tuned"] = nullptr;
  if (const std::optional<TunedShapes> result = tuned_result(world, tuner))
    report["tuned"] = TuneJson::parse(write_tuned({*result}))["results"][0];
  return report;
}

/// `tune --over`.
int compare_command(const CommandLine& line) {
  const Options& options = line.options;
  if (options.tune.brute_force) throw InputError("--brute-force: not with --over, which measures no map");
  const std::pair<const char*, const std::string*> files[] = {{"--picture", &options.tune.picture},
                                                              {"--kernel-tuner", &options.tune.kernel_tuner},
                                                              {"--t4", &options.tune.t4}};
  for (const auto& [flag, name] : files)
    if (!name->empty()) throw InputError(fmt::format("{}: not with --over, which measures no map", flag));
  std::optional<OutputFile> json;
  if (!options.json.empty() && options.json != "-") json.emplace("--json", options.json);
  const Start start = load_start(line);
  World world = start.world(options.run);
  world.step(static_cast<int>(options.steps_or(60)));
  const std::vector<SettingChoice> choices = setting_choices(world, options.tune.over);
  if (choices.empty()) throw InputError("--over: this run has no other value of these settings");
  SettingComparison result;
  {
    Progress progress("measurements", 1000);
    result = compare_settings(world, choices, options.tune.budget,
                              [&](double share) { progress.update(std::llround(1000 * share)); });
  }
  const std::string report = settings_json(world, result).dump(2) + '\n';
  if (json) {
    json->write(report);
    json->commit();
  }
  print(options.json == "-" ? report : settings_text(world, result));
  int wrong = 0;
  for (const ComparedSetting& row : result.rows) {
    if (row.difference.empty()) continue;
    ++wrong;
    fmt::print(stderr, "{} {}: {}\n", row.axis, row.value, row.difference);
  }
  return wrong > 0 ? 1 : 0;
}

/// The map: a row per B, a column per T.
std::string map_text(const TunedRun& run, const LaunchTuner& tuner) {
  const LaunchSearch& search = tuner.search();
  std::set<int> blocks, threads;
  for (const LaunchCell& cell : search.cells())
    blocks.insert(cell.shape.blocks), threads.insert(cell.shape.threads);
  std::string text = "ms per step      T\n     B";
  for (const int t : threads) text += fmt::format("{:>9}", t);
  text += '\n';
  for (const int b : blocks) {
    text += fmt::format("{:>6}", b);
    for (const int t : threads) {
      const auto cell = std::ranges::find(search.cells(), LaunchShape{b, t}, &LaunchCell::shape);
      std::string entry;
      if (cell == search.cells().end() || cell->state == LaunchCell::State::waiting)
        entry = "";
      else if (cell->state == LaunchCell::State::infeasible)
        entry = "x";
      else if (cell->state == LaunchCell::State::left_out)
        entry = "-";
      else if (cell->state == LaunchCell::State::wrong)
        entry = "WRONG";
      else
        entry = fmt::format("{:.3f}", typical_ms(run, *cell));
      const bool is_chosen = search.chosen() && &search.cells()[*search.chosen()] == &*cell;
      text += fmt::format("{:>8}{}", entry, is_chosen ? '*' : ' ');
    }
    text += '\n';
  }
  return text + "* chosen; - left out, beyond a much slower shape; x infeasible\n";
}

std::string text_of(const TunedRun& run, const LaunchTuner& tuner) {
  const LaunchSearch& search = tuner.search();
  const std::string reference = shape_text(run.reference);
  std::string text =
      fmt::format("{}, {} bodies, state {}, on {}: {} takes {:.3f} ms per step\n\n{}\n", run.scene,
                  run.bodies, run.state, run.device, reference, run.reference_ms, map_text(run, tuner));
  const std::optional<std::size_t> chosen = search.chosen();
  if (!chosen) return text + verdict_line(search, run.reference) + '\n';
  text += fmt::format("{}; the centre of {} shapes that cannot be told apart; {:.1f} s\n\n",
                      verdict_line(search, run.reference), search.plateau().size(), tuner.spent());
  text += fmt::format("{:<20}{:>10}{:>10}{:>10}  {}\n", "ms of a stage", "reference", "chosen", "best",
                      "best shape");
  const StageShapes best = tuner.stage_shapes();
  for (const LaunchTuner::Stage& stage : tuner.stages()) {
    if (!stage.obeys) continue;
    text += fmt::format("{:<20}{:>10.4f}{:>10.4f}", stage.name, stage.reference_ms, stage.cell_ms[*chosen]);
    if (const auto shape = std::ranges::find(best, stage.name, &StageShape::stage); shape != best.end())
      text += fmt::format("{:>10.4f}  {}", stage.reference_ms * stage.confirmation.ratio,
                          shape_text(shape->shape));
    text += '\n';
  }
  if (!tuner.compared_stages())
    return text + "the budget was too short to compare the shapes of single stages\n";
  if (best.empty()) return text + "no stage is faster with another shape\n";
  return text + fmt::format("the best shape of each stage: {}\n--stage-shapes {}\n",
                            verdict(tuner.stage_confirmation(), reference), stage_shapes_text(best));
}

/// All measurements. Throws Cancelled.
std::optional<BruteForce> measure(const Options& options, World& world, LaunchTuner& tuner) {
  {
    Progress progress("measurements", 1000);
    while (!tuner.done()) {
      tuner.advance(100);
      progress.update(std::min<std::int64_t>(std::llround(1000 * tuner.spent() / options.tune.budget), 1000));
    }
  }
  if (!options.tune.brute_force || !tuner.search().chosen()) return std::nullopt;
  Progress progress("all shapes", 1000);
  return brute_force(world, tuner.search(),
                     [&](double share) { progress.update(std::llround(1000 * share)); });
}

std::string stopped_note(const Options& options) {
  if (options.json.empty() || options.json == "-")
    return "stopped; measurements not saved; with --json FILE, the same command can continue\n";
  return fmt::format("stopped; run the same command again to continue from {}\n", options.json);
}

}  // namespace

int tune_command(const CommandLine& line) {
  const Options& options = line.options;
  if (!options.tune.over.empty()) return compare_command(line);
  // All files are tried before anything is measured.
  const auto file = [](const char* flag, const std::string& name) {
    return name.empty() ? std::nullopt : std::optional<OutputFile>(std::in_place, flag, name);
  };
  std::optional<OutputFile> json = file("--json", options.json == "-" ? "" : options.json),
                            cache = file("--kernel-tuner", options.tune.kernel_tuner),
                            results = file("--t4", options.tune.t4),
                            picture = file("--picture", options.tune.picture),
                            tuned = file("--tuned", options.tuned == "off" ? "" : options.tuned);
  if (tuned && std::filesystem::exists(options.tuned)) read_tuned(options.tuned);  // throws if it has a fault
  if (picture) ChartPicture(8, 8);  // throws if the machine cannot draw
  const Start start = load_start(line);
  World world = start.world(options.run);
  world.step(static_cast<int>(options.steps_or(60)));
  const int confirmation_pairs = static_cast<int>(options.tune.confirmation_pairs);
  const TuneJson identity = search_identity(world, confirmation_pairs);
  LaunchTuner tuner(world, options.tune.budget, confirmation_pairs);
  resume_search(options.json, identity, tuner);
  std::optional<BruteForce> all;
  try {
    all = measure(options, world, tuner);
  } catch (const Cancelled&) {
    InterruptHandler::wait_for_work();
    if (json) {
      json->write(progress_json(identity, tuner.record()).dump() + '\n');
      json->commit();
    }
    std::fputs(stopped_note(options).c_str(), stderr);
    throw;
  }
  const TunedRun run = tuned_run(world, tuner);
  TuneJson json_report = report_of(world, run, tuner);
  if (all)
    json_report["brute_force"] = {
        {"shapes", all->shapes},        {"blocks", all->best.blocks},
        {"threads", all->best.threads}, {"over_chosen", estimate_json(all->estimate)},
        {"agrees", all->agrees()},      {"seconds", all->seconds}};
  const std::string report = json_report.dump(2) + '\n';
  const auto write = [](std::optional<OutputFile>& target, const auto& text_of_file) {
    if (!target) return;
    target->write(text_of_file());
    target->commit();
  };
  write(json, [&]() -> const std::string& { return report; });
  write(cache, [&] { return kernel_tuner_cache(run, tuner.search()); });
  write(results, [&] { return t4_results(run, tuner.search()); });
  if (picture)  // write_png() replaces the file at once
    write_png(ChartPicture().draw(launch_map(run, tuner.search())), options.tune.picture);
  const std::string kept = keep_result(options, tuned ? &*tuned : nullptr, world, tuner);
  std::string text = text_of(run, tuner) + kept + (kept.empty() ? "" : "\n");
  if (all) text += text_of(*all, tuner.search().cells()[*tuner.search().chosen()].shape);
  print(options.json == "-" ? report : text);
  int wrong = 0;
  for (const LaunchCell& cell : tuner.search().cells()) {
    if (cell.state != LaunchCell::State::wrong) continue;
    ++wrong;
    fmt::print(stderr, "{}: {}\n", shape_text(cell.shape), cell.reason);
  }
  if (!tuner.stage_difference().empty())
    fmt::print(stderr, "the best shape of each stage: {}\n", tuner.stage_difference());
  return wrong > 0 || !tuner.stage_difference().empty() || (all && !all->agrees()) ? 1 : 0;
}

}  // namespace collidoscope

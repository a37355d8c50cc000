#include "headless/tune.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "headless/cli/output_file.h"
#include "headless/cli/progress.h"
#include "headless/cli/standard_output.h"
#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/tuning/launch_tuner.h"

namespace collidoscope {
namespace {

using TuneJson = nlohmann::ordered_json;

const char* name_of_state(LaunchCell::State state) {
  switch (state) {
    case LaunchCell::State::waiting:
      return "not measured";
    case LaunchCell::State::measured:
      return "measured";
    case LaunchCell::State::infeasible:
      return "infeasible";
    case LaunchCell::State::left_out:
      return "left out";
    case LaunchCell::State::wrong:
      return "wrong hash";
  }
  return "";
}

std::string shape_text(LaunchShape shape) {
  const auto part = [](int value) { return value == 0 ? "auto" : std::to_string(value); };
  if (shape == LaunchShape{}) return "auto";
  return "B = " + part(shape.blocks) + ", T = " + part(shape.threads);
}

TuneJson estimate_json(const RatioEstimate& estimate) {
  TuneJson json{
      {"ratio", estimate.ratio}, {"low", estimate.low}, {"high", nullptr}, {"pairs", estimate.pairs}};
  if (std::isfinite(estimate.high)) json["high"] = estimate.high;
  return json;
}

/// "solve=264x128,relax=528x64".
std::string stage_shapes_text(const StageShapes& shapes) {
  std::vector<std::string> parts;
  for (const auto& [stage, shape] : shapes)
    parts.push_back(fmt::format("{}={}x{}", stage, shape.blocks, shape.threads));
  return fmt::format("{}", fmt::join(parts, ","));
}

double best_ms(const LaunchTuner& tuner, const LaunchTuner::Stage& stage, LaunchShape shape) {
  const std::vector<LaunchCell>& cells = tuner.search().cells();
  const auto cell = std::ranges::find(cells, shape, &LaunchCell::shape);
  return stage.cell_ms[static_cast<std::size_t>(cell - cells.begin())];
}

TuneJson report_of(World& world, const LaunchTuner& tuner) {
  const LaunchSearch& search = tuner.search();
  TuneJson report{{"scene", world.scene().name},
                  {"bodies", world.initial().radius.size()},
                  {"state", world.steps()},
                  {"device", world.info().device_name},
                  {"broad_phase", world.options().broad_phase},
                  {"physics_version", physics_version},
                  {"reference", {{"shape", shape_text(tuner.reference())}, {"ms", tuner.reference_ms()}}},
                  {"seconds", tuner.spent()}};
  report["cells"] = TuneJson::array();
  for (const LaunchCell& cell : search.cells()) {
    TuneJson one{
        {"blocks", cell.shape.blocks}, {"threads", cell.shape.threads}, {"state", name_of_state(cell.state)}};
    if (!cell.reason.empty()) one["reason"] = cell.reason;
    if (!cell.ratios.empty()) {
      one["ms"] = estimate_ratio(cell.ms).ratio;
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
      one["best_ms"] = best_ms(tuner, stage, shape->shape);
    }
    report["stages"].push_back(std::move(one));
  }
  report["stage_shapes"] = {{"flag", stage_shapes_text(best)},
                            {"confirmation", estimate_json(tuner.stage_confirmation())}};
  return report;
}

/// The map: a row per B, a column per T.
std::string map_text(const LaunchTuner& tuner) {
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
        entry = fmt::format("{:.3f}", estimate_ratio(cell->ms).ratio);
      const bool is_chosen = search.chosen() && &search.cells()[*search.chosen()] == &*cell;
      text += fmt::format("{:>8}{}", entry, is_chosen ? '*' : ' ');
    }
    text += '\n';
  }
  return text + "* chosen; - left out, beyond a much slower shape; x infeasible\n";
}

std::string text_of(World& world, const LaunchTuner& tuner) {
  const LaunchSearch& search = tuner.search();
  const std::string reference = shape_text(tuner.reference());
  std::string text = fmt::format("{}, {} bodies, state {}, on {}: {} takes {:.3f} ms per step\n\n{}\n",
                                 world.scene().name, world.initial().radius.size(), world.steps(),
                                 world.info().device_name, reference, tuner.reference_ms(), map_text(tuner));
  const std::optional<std::size_t> chosen = search.chosen();
  if (!chosen) return text + "no shape was measured; a longer --budget is needed\n";
  // A shape that is not faster is not worth a setting.
  const bool faster = search.confirmation().high < 1;
  text += fmt::format("{}: {}; {}the centre of {} shapes that cannot be told apart; {:.1f} s\n\n",
                      shape_text(search.cells()[*chosen].shape), verdict(search.confirmation(), reference),
                      faster ? "" : "so keep " + reference + "; ", search.plateau().size(), tuner.spent());
  text += fmt::format("{:<20}{:>10}{:>10}{:>10}  {}\n", "ms of a stage", "reference", "chosen", "best",
                      "best shape");
  const StageShapes best = tuner.stage_shapes();
  for (const LaunchTuner::Stage& stage : tuner.stages()) {
    if (!stage.obeys) continue;
    text += fmt::format("{:<20}{:>10.4f}{:>10.4f}", stage.name, stage.reference_ms, stage.cell_ms[*chosen]);
    if (const auto shape = std::ranges::find(best, stage.name, &StageShape::stage); shape != best.end())
      text += fmt::format("{:>10.4f}  {}", best_ms(tuner, stage, shape->shape), shape_text(shape->shape));
    text += '\n';
  }
  if (best.empty()) return text + "no stage is faster with another shape\n";
  return text + fmt::format("the best shape of each stage: {}\n--stage-shapes {}\n",
                            verdict(tuner.stage_confirmation(), reference), stage_shapes_text(best));
}

}  // namespace

int tune_command(const CommandLine& line) {
  const Options& options = line.options;
  std::optional<OutputFile> json;
  if (!options.json.empty() && options.json != "-") json.emplace("--json", options.json);
  const Start start = load_start(line);
  World world = start.world(options.run);
  world.step(static_cast<int>(options.steps_or(60)));
  LaunchTuner tuner(world, options.tune.budget);
  {
    Progress progress("measurements", 1000);
    while (!tuner.done()) {
      tuner.advance(100);
      progress.update(std::min<std::int64_t>(std::llround(1000 * tuner.spent() / options.tune.budget), 1000));
    }
  }
  const std::string report = report_of(world, tuner).dump(2) + '\n';
  if (json) {
    json->write(report);
    json->commit();
  }
  print(options.json == "-" ? report : text_of(world, tuner));
  int wrong = 0;
  for (const LaunchCell& cell : tuner.search().cells()) {
    if (cell.state != LaunchCell::State::wrong) continue;
    ++wrong;
    fmt::print(stderr, "{}: {}\n", shape_text(cell.shape), cell.reason);
  }
  if (!tuner.stage_difference().empty())
    fmt::print(stderr, "the best shape of each stage: {}\n", tuner.stage_difference());
  return wrong > 0 || !tuner.stage_difference().empty() ? 1 : 0;
}

}  // namespace collidoscope

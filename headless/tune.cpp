#include "headless/tune.h"

#include <fmt/format.h>

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

/// What one shape for all stages loses: the stage's time at the chosen shape over its best time.
struct StageLoss {
  std::string name;
  double reference_ms, chosen_ms, best_ms;
  std::size_t best;
};

std::vector<StageLoss> stage_losses(const LaunchTuner& tuner, std::size_t chosen) {
  std::vector<StageLoss> losses;
  for (const LaunchTuner::Stage& stage : tuner.stages()) {
    if (!stage.obeys) continue;
    StageLoss loss{stage.name, stage.reference_ms, stage.cell_ms[chosen], stage.cell_ms[chosen], chosen};
    for (std::size_t cell = 0; cell < stage.cell_ms.size(); ++cell) {
      // The median of two samples is too rough for a best value.
      const bool known = tuner.search().cells()[cell].ratios.size() > LaunchSearch::first_pairs;
      if (known && stage.cell_ms[cell] < loss.best_ms) loss.best_ms = stage.cell_ms[cell], loss.best = cell;
    }
    losses.push_back(loss);
  }
  return losses;
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
  const LaunchShape shape = search.cells()[*chosen].shape;
  report["chosen"] = {{"blocks", shape.blocks},
                      {"threads", shape.threads},
                      {"confirmation", estimate_json(search.confirmation())},
                      {"verdict", verdict(search.confirmation(), shape_text(tuner.reference()))}};
  report["stages"] = TuneJson::array();
  for (const StageLoss& loss : stage_losses(tuner, *chosen)) {
    const LaunchShape best = search.cells()[loss.best].shape;
    report["stages"].push_back({{"name", loss.name},
                                {"reference_ms", loss.reference_ms},
                                {"chosen_ms", loss.chosen_ms},
                                {"best_ms", loss.best_ms},
                                {"best", {best.blocks, best.threads}}});
  }
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
  return text + "* chosen; - left out: fewer threads than a much slower shape; x infeasible\n";
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
  text += fmt::format("{:<28}{:>10}{:>10}{:>10}  {}\n", "ms of a stage", reference, "chosen", "best",
                      "best shape");
  double at_chosen = 0, at_best = 0;
  for (const StageLoss& loss : stage_losses(tuner, *chosen)) {
    text += fmt::format("{:<28}{:>10.4f}{:>10.4f}{:>10.4f}  {}\n", loss.name, loss.reference_ms,
                        loss.chosen_ms, loss.best_ms, shape_text(search.cells()[loss.best].shape));
    at_chosen += loss.chosen_ms;
    at_best += loss.best_ms;
  }
  return text + fmt::format("One shape for all stages takes {:.3f} ms, the best shape of each {:.3f} ms\n",
                            at_chosen, at_best);
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
  return wrong > 0 ? 1 : 0;
}

}  // namespace collidoscope

#include "headless/cli/tuned_option.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "sim_cuda/core/atomic_file.h"
#include "sim_cuda/tuning/tuned_file.h"

namespace collidoscope {

void load_tuned(Options& options) {
  if (options.tuned == "off") return;
  std::vector<TunedShapes>& shapes = options.run.tuned_shapes;
  if (!options.tuned.empty()) {
    shapes = read_tuned(options.tuned);
    for (TunedShapes& one : shapes) one.named_by_user = true;
    return;
  }
  std::vector<std::string> warnings;
  shapes = known_tuned(warnings);
  for (const std::string& warning : warnings)
    fmt::print(stderr, "{}; its launch shapes are not used\n", warning);
}

std::optional<TunedShapes> tuned_result(const World& world, const LaunchTuner& tuner) {
  if (tuner.reference() != LaunchShape{} || !world.options().stage_shapes.empty()) return std::nullopt;
  TunedShapes result;
  result.conditions = world.tuning_conditions();
  if (const std::optional<std::size_t> chosen = tuner.search().chosen()) {
    result.ratio = tuner.search().confirmation();
    result.shape = tuner.search().cells()[*chosen].shape;
  }
  const RatioEstimate by_stage = tuner.stage_confirmation();
  if (tuner.stage_difference().empty() && by_stage.high < 1 && by_stage.ratio < result.ratio.ratio) {
    result.ratio = by_stage;
    result.shape = {};
    result.stages = tuner.stage_shapes();
  }
  return std::isfinite(result.ratio.high) ? std::optional(result) : std::nullopt;
}

std::string keep_result(const Options& options, OutputFile* named, World& world, const LaunchTuner& tuner) {
  const std::string file = options.tuned.empty() ? tuned_cache() : options.tuned;
  const std::optional<TunedShapes> result = tuned_result(world, tuner);
  if (file.empty() || options.tuned == "off" || !result) return "";
  if (named != nullptr) {
    named->write(with_tuned(file, *result));
    named->commit();
  } else {
    try {
      write_file_atomically(file, with_tuned(file, *result));
    } catch (const std::runtime_error& error) {  // the measurement is not lost
      return fmt::format("not kept: {}", error.what());
    }
  }
  return fmt::format("kept in {}: auto will {}", file,
                     result->ratio.high < 1 ? "use these shapes" : "not change");
}

}  // namespace collidoscope

#include "sim_cuda/accuracy/problem.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "sim_cuda/accuracy/errors.h"
#include "sim_cuda/core/statistics.h"
#include "sim_cuda/scene/limits.h"

namespace collidoscope {

int AccuracyProblem::steps_between(const AccuracySetting& setting) const {
  return stride * static_cast<int>(std::lround(coarsest / setting.time_step));
}

AccuracySetting AccuracyProblem::own_setting() const {
  return accuracy_setting(scene.physics, substeps, effects);
}

double coarsest_step(double time_step) {
  return 2 * time_step <= limits::max_time_step ? 2 * time_step : time_step;
}

AccuracyProblem make_accuracy_problem(const Scene& given, const RunOptions& options, double seconds,
                                      const RunState* start) {
  constexpr int most_samples = 32;
  Scene scene = given;
  disable_guards(scene.physics);
  World world(scene, options, start);
  const double step = scene.physics.time_step;
  if (seconds == 0) seconds = std::max(2.0, 60 * step);
  AccuracyProblem problem{.scene = scene,
                          .options = options,
                          .start = world.state(),
                          .initial = world.initial(),
                          .effects = world.effects(),
                          .substeps = world.substeps(),
                          .coarsest = coarsest_step(step)};
  const int steps = std::max(1, static_cast<int>(std::min(seconds / problem.coarsest * (1 + 1e-12), 1e9)));
  problem.options.tuned_shapes.clear();  // they may exist for some of the compared settings only
  problem.samples = std::min(steps, most_samples);
  problem.stride = (steps + problem.samples - 1) / problem.samples;
  problem.samples = steps / problem.stride;
  problem.start.steps = 0;
  problem.start.time = 0;
  std::ranges::fill(problem.start.static_impulses, StaticImpulse{});
  const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
  const int threads = options.cpu_threads > 0 ? options.cpu_threads : static_cast<int>(cores);
  const WorldInfo info = world.info();
  problem.executor =
      info.on_gpu ? fmt::format("CUDA: {}", info.device_name)
                  : fmt::format("CPU, {} thread{}: {}", threads, threads == 1 ? "" : "s", info.device_name);
  return problem;
}

SampledRun::SampledRun(const AccuracyProblem& problem, const AccuracySetting& setting, const RunState& start)
    : problem_(problem),
      world_(with_setting(problem.scene, setting, problem.effects), problem.options, &start),
      step_(setting.time_step),
      between_(problem.steps_between(setting)) {}

bool SampledRun::reach_next(const Deadline& slice) {
  do {
    const bool plain = world_.steps() % 2 == 0;
    world_.step();
    ++done_;
    if (plain) {
      stretch_.push_back(world_.latest_times().step_last_ms);
      ++plain_steps_;
    }
  } while (done_ % between_ != 0 && !slice.passed());
  if (done_ % between_ != 0) return false;
  ++sample_;
  if (!stretch_.empty()) medians_.push_back(quantile(stretch_, 0.5));
  stretch_.clear();
  return true;
}

double SampledRun::cost_ms_per_second() const {
  double sum = 0;
  for (const double each : medians_) sum += each;
  return medians_.empty() ? not_known : sum / static_cast<double>(medians_.size()) / step_;
}

void SampledRun::restart(const RunState& start) {
  world_.restore(start);
  done_ = sample_ = plain_steps_ = 0;
  stretch_.clear();
  medians_.clear();
}

}  // namespace collidoscope

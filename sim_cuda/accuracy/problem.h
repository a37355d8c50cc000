#pragma once
// The problem of an accuracy study: scene, start state and sample times. Sample times are integer multiples
// of every setting's step. Plain data. Also runs a setting in time slices.

#include <optional>

#include "sim_cuda/accuracy/point.h"
#include "sim_cuda/core/deadline.h"
#include "sim_cuda/run/run_state.h"
#include "sim_cuda/world.h"

namespace collidoscope {

struct AccuracyProblem {
  Scene scene;
  RunOptions options;
  RunState start;  ///< step number 0, no ledgers; rounded to the scene's precision, so all runs start equal
  InitialBodies initial;
  Effects effects;         ///< effects of the scene at its own time step
  int substeps = 1;        ///< substeps of the scene at its own time step
  double coarsest = 0;     ///< s, longest time step; all others divide it
  int samples = 0;         ///< number of samples, without the start
  int stride = 1;          ///< coarsest steps between samples
  std::string executor{};  ///< for example "CPU, 2 threads: AMD EPYC"

  double time(int sample) const { return sample * stride * coarsest; }  ///< s
  /// Steps of a setting between two samples.
  int steps_between(const AccuracySetting& setting) const;
  /// The scene's own setting.
  AccuracySetting own_setting() const;
};

/// Longest time step in s that a study compares for a scene with this time step.
double coarsest_step(double time_step);

/// Creates the problem. `seconds`: maximum duration, up to one coarsest step more; 0: 60 of the scene's own
/// steps, and at least 2 s. `start`: null for state 0. Throws the same exceptions as World.
AccuracyProblem make_accuracy_problem(const Scene& scene, const RunOptions& options, double seconds,
                                      const RunState* start = nullptr);

/// A run with one setting that stops at each sample. `problem` must outlive it. Throws the same exceptions as
/// World.
class SampledRun {
 public:
  SampledRun(const AccuracyProblem& problem, const AccuracySetting& setting, const RunState& start);
  /// Steps until the next sample (returns true) or the end of the slice (returns false). Makes at least one
  /// step.
  bool reach_next(const Deadline& slice);
  int sample() const { return sample_; }  ///< last sample reached; 0: the start
  World& world() { return world_; }
  /// Cost in ms per simulated second: mean over the intervals between samples of the median time of plain
  /// steps. Plain steps are the even-numbered steps, whose stages are not timed. The median suppresses steps
  /// delayed by other programs.
  double cost_ms_per_second() const;
  int plain_steps() const { return plain_steps_; }
  /// Resets the state to the start and keeps recorded graphs and grown buffers. The cost then covers steps
  /// only.
  void restart(const RunState& start);

 private:
  const AccuracyProblem& problem_;
  World world_;
  double step_;  // s
  int between_, done_ = 0, sample_ = 0;
  int plain_steps_ = 0;
  std::vector<double> stretch_;  // ms, plain steps since the last sample
  std::vector<double> medians_;  // ms, medians of the earlier intervals
};

}  // namespace collidoscope

#pragma once
// What an accuracy study is of: a scene, where its runs start, and the times at which they are looked at,
// which are whole numbers of steps for every setting. Plain data; the runs of it, in slices.

#include <optional>

#include "sim_cuda/accuracy/point.h"
#include "sim_cuda/core/deadline.h"
#include "sim_cuda/run/run_state.h"
#include "sim_cuda/world.h"

namespace collidoscope {

struct AccuracyProblem {
  Scene scene;
  RunOptions options;
  RunState start;  ///< numbered 0, ledgers empty; rounded to the scene's own precision, all runs start equal
  InitialBodies initial;
  Effects effects;         ///< of the scene at its own time step
  int substeps = 1;        ///< the same
  double coarsest = 0;     ///< s, the longest time step; all others are whole parts of it
  int samples = 0;         ///< looked at beside the start
  int stride = 1;          ///< coarsest steps from one to the next
  std::string executor{};  ///< "CPU, 2 threads: AMD EPYC"

  double time(int sample) const { return sample * stride * coarsest; }  ///< s
  /// Steps of a setting between two samples.
  int steps_between(const AccuracySetting& setting) const;
  /// The setting that the scene itself has.
  AccuracySetting own_setting() const;
};

/// s, the longest time step that a study of such a scene compares.
double coarsest_step(double time_step);

/// `seconds`: how long at most, but for one coarsest step; 0: 60 of the scene's own steps, and at least 2 s;
/// `start`: unset, state 0. Throws as World does.
AccuracyProblem make_accuracy_problem(const Scene& scene, const RunOptions& options, double seconds,
                                      const RunState* start = nullptr);

/// A world that goes from sample to sample; `problem` outlives it. Throws as World does.
class SampledRun {
 public:
  SampledRun(const AccuracyProblem& problem, const AccuracySetting& setting, const RunState& start);
  /// Steps until it is at the next sample, which makes true, or the slice is over; at least one step.
  bool reach_next(const Deadline& slice);
  int sample() const { return sample_; }  ///< last reached; 0: the start
  World& world() { return world_; }
  /// ms for a simulated second: the mean over the stretches between samples of the median of their plain
  /// steps (even-numbered ones, none of whose stages is timed), so that a step which had to wait for another
  /// program counts for little.
  double cost_ms_per_second() const;
  int plain_steps() const { return plain_steps_; }
  /// Back to the start, with what was recorded and grown on the way: so that costs are of steps alone.
  void restart(const RunState& start);

 private:
  const AccuracyProblem& problem_;
  World world_;
  double step_;  // s
  int between_, done_ = 0, sample_ = 0;
  int plain_steps_ = 0;
  std::vector<double> stretch_;  // ms, of plain steps since the last sample
  std::vector<double> medians_;  // ms, of the stretches before
};

}  // namespace collidoscope

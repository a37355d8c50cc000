#pragma once
// AccuracyStudy: error versus run time of one scene over many settings.
// Works in time slices, so that a viewer keeps drawing and a headless run can be stopped. First it computes
// the reference, then the error of each setting, and the costs in separate runs. Cost runs alternate between
// settings, so that other load affects all settings alike.
// Owns all its data; runs one world at a time. Points are available as soon as they are measured. A later
// study of the same problem can resume from them. Throws the same exceptions as World, and InputError if no
// body of the scene moves.

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/accuracy/point.h"
#include "sim_cuda/accuracy/problem.h"
#include "sim_cuda/accuracy/record.h"
#include "sim_cuda/accuracy/reference.h"

namespace collidoscope {

struct AccuracyStudyOptions {
  double seconds = 0;  ///< s of simulated time, approximately; 0: 60 of the scene's own steps, and at least 2
                       ///< s
  int rounds = 5;      ///< number of runs per cost; the median is used
  /// For tests: only these settings (series, name, setting), and another scene with the same bodies as the
  /// reference.
  std::optional<std::vector<AccuracyPoint>> settings{};
  std::optional<Scene> reference_scene{};
};

class AccuracyStudy {
 public:
  /// Starts from state 0, or from `start`, a state of a run of this scene.
  AccuracyStudy(const Scene& scene, const RunOptions& options, AccuracyStudyOptions request = {},
                const RunState* start = nullptr);

  ~AccuracyStudy();

  /// Works for about this many milliseconds. Returns false when done.
  bool advance(double milliseconds);

  const AccuracyProblem& problem() const { return problem_; }
  const AccuracyStudyOptions& request() const { return request_; }
  /// Null until the reference is computed.
  const AccuracyReference* reference() const { return samples_.empty() ? nullptr : &reference_; }
  /// Samples of the reference from the start up to AccuracyReference::seconds.
  const std::vector<ReferenceSample>& samples() const { return samples_; }
  /// All settings from coarse to fine, with the results known so far and the Pareto front marked. Empty until
  /// the reference is computed.
  const std::vector<AccuracyPoint>& points() const { return points_; }
  /// Warnings for the user from the convergence check of the finest runs.
  const std::vector<std::string>& warnings() const { return warnings_; }

  struct Progress {
    std::int64_t done = 0, total = 1;  ///< thousandths of the reference, then runs
    std::string current_task;
  };
  Progress progress() const;

  /// All results so far.
  AccuracyRecord record() const;
  /// Restores the results of a record. Call before the first advance(). Returns false, without effect, if the
  /// record is of another problem, machine or physics version.
  bool restore(const AccuracyRecord& record);

 private:
  struct Job {
    std::size_t point;
    int round;  // round of the cost; -1: error
  };
  void plan();
  bool done() const { return !reference_run_ && next_ == jobs_.size(); }
  bool measure_error(const Deadline& slice);
  bool measure_cost(const Deadline& slice);
  void finish_error();
  void compare_sample();
  void check_convergence();

  AccuracyStudyOptions request_;
  AccuracyProblem problem_;
  std::optional<AccuracyProblem> reference_problem_;
  std::unique_ptr<ReferenceRun> reference_run_;  // while the reference is computed
  AccuracyReference reference_;
  std::vector<ReferenceSample> samples_;
  int horizon_ = 0;
  InvariantScales scales_;
  std::vector<AccuracyPoint> points_, recorded_points_;
  std::vector<Job> jobs_;
  std::size_t next_ = 0;  // index in jobs_
  std::vector<std::string> warnings_;
  std::map<std::size_t, BodyStates> at_horizon_;  // by point, for the two finest settings of each series in
                                                  // double

  struct ErrorRun;
  std::unique_ptr<ErrorRun> error_run_;   // of the current job
  std::unique_ptr<SampledRun> cost_run_;  // of the current job
  std::vector<double> costs_;             // of the current job's runs so far
  int cost_steps_ = 0;                    // plain steps of these runs
};

}  // namespace collidoscope

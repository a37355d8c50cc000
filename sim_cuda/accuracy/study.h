#pragma once
// AccuracyStudy: what accuracy costs in one scene. Made from the scene, it works in slices, so that a window
// keeps drawing and a run without one can be stopped: first the reference, then each setting's error, and its
// cost by runs of their own, which take turns so that a busy machine slows them all alike. Owns all it uses;
// runs one world at a time. Points appear as they are measured, and can be given back to a later study of the
// same, which goes on from there. Throws as World does; InputError where nothing of the scene moves.

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
  double seconds = 0;  ///< s of simulated time, about; 0: 60 of the scene's own steps, and at least 2 s
  int rounds = 5;      ///< runs that a cost is the middle of
  /// For tests: these settings (series, name, setting) and no others; and a scene of the same bodies that is
  /// what errors are measured against.
  std::optional<std::vector<AccuracyPoint>> settings{};
  std::optional<Scene> reference_scene{};
};

class AccuracyStudy {
 public:
  /// From state 0, or from `start`: where a run of this scene stands.
  AccuracyStudy(const Scene& scene, const RunOptions& options, AccuracyStudyOptions request = {},
                const RunState* start = nullptr);

  ~AccuracyStudy();

  /// Works for about so many milliseconds; false once all is done.
  bool advance(double milliseconds);

  const AccuracyProblem& problem() const { return problem_; }
  const AccuracyStudyOptions& request() const { return request_; }
  /// Null until it is known.
  const AccuracyReference* reference() const { return samples_.empty() ? nullptr : &reference_; }
  /// By sample, the start first; up to AccuracyReference::seconds.
  const std::vector<ReferenceSample>& samples() const { return samples_; }
  /// All settings, coarse to fine, with what is known of each; empty until the reference is known. The front
  /// is marked.
  const std::vector<AccuracyPoint>& points() const { return points_; }
  /// What a second look at the finest runs has found wrong: lines for the user.
  const std::vector<std::string>& warnings() const { return warnings_; }

  struct Progress {
    std::int64_t done = 0, total = 1;  ///< thousandths of the reference, then runs
    std::string current_task;
  };
  Progress progress() const;

  /// All that is known so far.
  AccuracyRecord record() const;
  /// Takes what a record knows, before the first advance(); false, and nothing, where it is of another study
  /// or of another machine.
  bool restore(const AccuracyRecord& record);

 private:
  struct Job {
    std::size_t point;
    int round;  // of its cost; -1: its error
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
  std::unique_ptr<ReferenceRun> reference_run_;  // while it is
  AccuracyReference reference_;
  std::vector<ReferenceSample> samples_;
  int horizon_ = 0;
  InvariantScales scales_;
  std::vector<AccuracyPoint> points_, recorded_points_;
  std::vector<Job> jobs_;
  std::size_t next_ = 0;  // job
  std::vector<std::string> warnings_;
  std::map<std::size_t, BodyStates> at_horizon_;  // by point, of the two finest of each ladder in double

  struct ErrorRun;
  std::unique_ptr<ErrorRun> error_run_;   // of the job at hand
  std::unique_ptr<SampledRun> cost_run_;  // of the job at hand
  std::vector<double> costs_;             // of its runs so far
  int cost_steps_ = 0;                    // plain ones, of these
};

}  // namespace collidoscope

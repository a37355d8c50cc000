#pragma once
// Computes the reference solution of a study in time slices, and estimates its error. One per study. Owns its
// runs and samples.
//
// Event-driven hard spheres (reference/hard_spheres.h) are used if they support the scene and reach at least
// a third of the time. They are exact up to rounding and up to their first Zeno point.
// Otherwise the reference is a converged run: the scene in double by soft_step, with steps h, h/2 and h/4,
// where h is a sixteenth of the scene's own step. The distances d1 = |x_h - x_{h/2}| and d2 = |x_{h/2} -
// x_{h/4}| give:
// - the order p = log2(d1/d2),
// - the remaining error d2/(2^p - 1) (Richardson),
// - the horizon: positions are compared up to the last sample before which d2 < 0.71 d1.
//
// A second run measures the predictability horizon in both cases. Its start differs by at most 1e-8 of each
// radius. The horizon ends where this displacement has grown a thousandfold; an error of 1 mm would then be 1
// m.

#include <memory>

#include "sim_cuda/accuracy/invariants.h"
#include "sim_cuda/accuracy/problem.h"
#include "sim_cuda/reference/hard_spheres.h"

namespace collidoscope {

class ReferenceRun {
 public:
  /// Computes the reference of `problem`, or, in tests, of another scene with the same bodies. The problem
  /// must outlive the run.
  explicit ReferenceRun(const AccuracyProblem& problem);
  ~ReferenceRun();

  /// Works for one slice. Returns false when done.
  bool advance(const Deadline& slice);
  /// Completed share of the work, 0 to 1.
  double progress() const;
  const std::string& current_task() const { return current_task_; }

  /// Samples from 0 (the start) to the last one that the reference reaches. Precondition: done.
  std::vector<ReferenceSample> take_samples() { return std::move(samples_); }
  const AccuracyReference& result() const { return result_; }
  /// Last sample at which positions are compared.
  int horizon() const { return horizon_; }
  double fastest() const { return fastest_; }  ///< m/s, of any body

 private:
  bool advance_spheres(const Deadline& slice);
  bool advance_runs(const Deadline& slice);
  void begin_spheres();
  void begin_runs(const std::string& why);
  void finish_spheres();
  void finish_runs();
  /// Shortens the horizon if a displacement grows too far. Returns the growth factor at the horizon.
  double measure_growth(const std::vector<BodyStates>& other, const std::vector<const BodyStates*>& same,
                        double first);
  double distance(const BodyStates& a, const BodyStates& b) const;

  const AccuracyProblem& problem_;
  AccuracyReference result_;
  std::string current_task_;
  std::unique_ptr<HardSpheres> exact_, perturbed_;  // only in the event-driven case
  std::unique_ptr<SampledRun> run_;                 // current converged run
  AccuracySetting setting_;                         // of the first converged run
  int runs_done_ = 0;                               // order: h, perturbed, h/2, h/4
  RunState perturbed_start_;
  std::vector<ReferenceSample> samples_;
  std::vector<BodyStates> first_, second_, third_;  // states of the runs h, perturbed, h/2
  int horizon_ = 0;
  double fastest_ = 0;
  bool done_ = false;
};

}  // namespace collidoscope

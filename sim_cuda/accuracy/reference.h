#pragma once
// The answer that a scene's settings are measured against, made in slices of work, with how far it can be
// trusted. One for each study; owns its runs while they go on, and the samples they leave.
//
// Event-driven hard spheres (reference/hard_spheres.h) where they know the scene and reach at least a third
// of the time: exact but for rounding, up to their first Zeno point. Otherwise a converged run: the scene
// itself in double by soft_step, at steps of h, h/2 and h/4, h a sixteenth of the scene's own. Of their
// distances d1 = |x_h - x_{h/2}| and d2 = |x_{h/2} - x_{h/4}| come the order p = log2(d1/d2), the error that
// the last one still has, d2/(2^p - 1) (Richardson), and whether they converge at all: positions are compared
// up to the last sample before which d2 < 0.71 d1.
//
// How long positions mean anything is measured in either case by a second run from a start that differs by
// 1e-8 of each radius or less: the horizon is where such a displacement has grown a thousandfold, so that
// an error of a millimetre would have become a metre.

#include <memory>

#include "sim_cuda/accuracy/invariants.h"
#include "sim_cuda/accuracy/problem.h"
#include "sim_cuda/reference/hard_spheres.h"

namespace collidoscope {

class ReferenceRun {
 public:
  /// Of `problem`, or, for tests, of another scene of the same bodies. Both outlive it.
  explicit ReferenceRun(const AccuracyProblem& problem);
  ~ReferenceRun();

  /// Works for a slice; false once it is done.
  bool advance(const Deadline& slice);
  /// Shares of the work, 0 to 1.
  double progress() const;
  const std::string& current_task() const { return current_task_; }

  /// Samples 0 (the start) to the last that the reference reaches. Once it is done.
  std::vector<ReferenceSample> take_samples() { return std::move(samples_); }
  const AccuracyReference& result() const { return result_; }
  /// Up to which positions are compared.
  int horizon() const { return horizon_; }
  double fastest() const { return fastest_; }  ///< m/s, of any body

 private:
  bool advance_spheres(const Deadline& slice);
  bool advance_runs(const Deadline& slice);
  void begin_spheres();
  void begin_runs(const std::string& why);
  void finish_spheres();
  void finish_runs();
  /// Ends the horizon where a displacement has grown too far; returns how far by then, times.
  double measure_growth(const std::vector<BodyStates>& other, const std::vector<const BodyStates*>& same,
                        double first);
  double distance(const BodyStates& a, const BodyStates& b) const;

  const AccuracyProblem& problem_;
  AccuracyReference result_;
  std::string current_task_;
  std::unique_ptr<HardSpheres> exact_, perturbed_;  // while there is an event-driven answer
  std::unique_ptr<SampledRun> run_;                 // of the converged runs, that which goes on
  AccuracySetting setting_;                         // of the first of them
  int runs_done_ = 0;                               // h, perturbed, h/2, h/4
  RunState perturbed_start_;
  std::vector<ReferenceSample> samples_;
  std::vector<BodyStates> first_, second_, third_;  // of runs h, perturbed, h/2
  int horizon_ = 0;
  double fastest_ = 0;
  bool done_ = false;
};

}  // namespace collidoscope

#pragma once
// Invariants that a run must satisfy for every motion: balances of energy and momenta, overlap, joint error,
// friction cone. One collector per run; it evaluates every sample.

#include "sim_cuda/accuracy/point.h"
#include "sim_cuda/accuracy/problem.h"

namespace collidoscope {

/// A state of the reference.
struct ReferenceSample {
  BodyStates bodies;
  StepStats stats;
};

/// Scales that make errors dimensionless: maxima over all samples of the reference.
struct InvariantScales {
  double energy = 1;            ///< J, maximum kinetic energy
  double momentum = 1;          ///< kg m/s, maximum of the sum of m |v|
  double angular_momentum = 1;  ///< kg m^2/s, momentum scale times the extent of the bodies about their
                                ///< centre
  InvariantScales() = default;
  InvariantScales(const std::vector<ReferenceSample>& samples, const InitialBodies& bodies);
};

class InvariantCollector {
 public:
  /// The arguments must outlive the collector.
  InvariantCollector(const AccuracyProblem& problem, const InvariantScales& scales);
  /// `time`: s since the start. `expected`: statistics of the reference at that time, or null.
  void add_sample(World& world, double time, const StepStats* expected);
  const AccuracyInvariants& result() const { return result_; }

 private:
  void balance(const StepStats& now, double time);
  void overlap(World& world, const BodyStates& bodies);
  void cones(const RunState& state);

  const AccuracyProblem& problem_;
  const InvariantScales& scales_;
  StepStats first_;
  bool started_ = false;
  double squares_ = 0, shares_ = 0;  // m^2, and dimensionless; sums over the overlapping pairs of all samples
  std::int64_t overlaps_ = 0;
  AccuracyInvariants result_;
};

}  // namespace collidoscope

#pragma once
// What a run must keep, or must not have, whatever its motion: balances of energy and momenta, overlap, the
// error of joints, friction beyond its cone. One collector for each run, which looks at every sample.

#include "sim_cuda/accuracy/point.h"
#include "sim_cuda/accuracy/problem.h"

namespace collidoscope {

/// A state of the reference.
struct ReferenceSample {
  BodyStates bodies;
  StepStats stats;
};

/// What quantities are measured by, over all samples of the reference, so that errors have no unit.
struct InvariantScales {
  double energy = 1;            ///< J, the most kinetic energy
  double momentum = 1;          ///< kg m/s, the most sum of m |v|
  double angular_momentum = 1;  ///< kg m^2/s, that and the bodies' distance from their centre
  InvariantScales() = default;
  InvariantScales(const std::vector<ReferenceSample>& samples, const InitialBodies& bodies);
};

class InvariantCollector {
 public:
  /// Both outlive it.
  InvariantCollector(const AccuracyProblem& problem, const InvariantScales& scales);
  /// `time`: s since the start; `expected`: the reference's state then, or null.
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
  double squares_ = 0, shares_ = 0;  // m^2; sums over overlapping pairs of all samples
  std::int64_t overlaps_ = 0;
  AccuracyInvariants result_;
};

}  // namespace collidoscope

#pragma once
// Distances between two states of the same bodies, and between two distributions.
// The distance is the mass-weighted r.m.s. displacement of a body's points, in metres. A rotation counts by
// the displacement it causes. Only dynamic bodies are compared.

#include <vector>

#include "sim_cuda/scene/initial_bodies.h"
#include "sim_cuda/world.h"

namespace collidoscope {

/// Squared displacement by body, in m^2. It is |x - x'|^2 plus (2 sin a/2)^2 n.In/m for a rotation by the
/// angle a about the axis n between q and q'.
/// 0 for bodies that are not dynamic. Infinite if a state is not finite.
std::vector<double> squared_distances(const BodyStates& a, const BodyStates& b, const InitialBodies& bodies,
                                      bool turning);

/// Accumulates squared distances over several states.
class ErrorSum {
 public:
  void add(const std::vector<double>& squares);

  struct Result {
    double rms, low, high, worst;  ///< m; `low` and `high`: rms minus and plus one standard error, from 16
                                   ///< groups of bodies
  };
  /// Statistics over the dynamic bodies.
  Result result(const InitialBodies& bodies) const;

 private:
  std::vector<double> sum_;  // by body
  double worst_ = 0;
  int states_ = 0;
};

/// R.m.s. distance in m over the bodies of two states.
double rms_distance(const BodyStates& a, const BodyStates& b, const InitialBodies& bodies, bool turning);

/// Wasserstein distance (earth mover's distance): the mean distance by which values must move to turn one
/// distribution into the other, in their unit. Both need the same number of values, in any order. Infinite if
/// a value is not finite.
double distribution_distance(std::vector<double> a, std::vector<double> b);

/// Least-squares slope of log y over log x. `not_known` for fewer than two points.
double fitted_order(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace collidoscope

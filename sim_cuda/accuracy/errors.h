#pragma once
// How far two states of the same bodies are from each other, and how far two distributions. In metres, of a
// body's matter: a mean over its mass of the squares of how far each part is from where it should be, so that
// turns count as far as they move anything. For bodies that forces move; of others nothing is known.

#include <vector>

#include "sim_cuda/scene/initial_bodies.h"
#include "sim_cuda/world.h"

namespace collidoscope {

/// m^2, by body: |x - x'|^2, and for the turn by the angle a about the axis n between q and q'
/// (2 sin a/2)^2 n.In/m; 0 of bodies that no force moves. Infinite where a state is not finite.
std::vector<double> squared_distances(const BodyStates& a, const BodyStates& b, const InitialBodies& bodies,
                                      bool turning);

/// Sums of these over several states.
class ErrorSum {
 public:
  void add(const std::vector<double>& squares);

  struct Result {
    double rms, low, high, worst;  ///< m; `low` and `high`: a standard error off, from 16 groups of bodies
  };
  /// Over the bodies that forces move.
  Result result(const InitialBodies& bodies) const;

 private:
  std::vector<double> sum_;  // by body
  double worst_ = 0;
  int states_ = 0;
};

/// m, r.m.s. over bodies of one pair of states.
double rms_distance(const BodyStates& a, const BodyStates& b, const InitialBodies& bodies, bool turning);

/// Wasserstein's, also the earth mover's: how far values must be moved, on average, to make one distribution
/// of the other; in their unit. For as many values in both, in any order; infinite where one is not finite.
double distribution_distance(std::vector<double> a, std::vector<double> b);

/// The slope of log y over log x by least squares; `not_known` of fewer than two points.
double fitted_order(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace collidoscope

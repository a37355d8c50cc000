#pragma once
// Compares the shape that a launch search has chosen with the best of all shapes of its map, which are all
// measured as often (`tune --brute-force`).

#include <functional>

#include "sim_cuda/tuning/launch_search.h"
#include "sim_cuda/world.h"

namespace collidoscope {

struct BruteForce {
  int shapes = 0;          ///< number of measured shapes
  LaunchShape best;        ///< of the smallest median ratio to the chosen shape
  RatioEstimate estimate;  ///< best over chosen, from fresh pairs
  double seconds = 0;
  /// Whether the chosen shape is within 2 % of the best one, or cannot be told apart from it.
  bool agrees() const { return estimate.ratio > 0.98 || estimate.high >= 1; }
};

/// Measures 41 pairs of each feasible shape over the chosen one; shapes that take twice as long get two. The
/// world is only read. `progress` gets the finished share, 0 to 1. Precondition: a shape is chosen.
BruteForce brute_force(World& world, const LaunchSearch& search, const std::function<void(double)>& progress);

}  // namespace collidoscope

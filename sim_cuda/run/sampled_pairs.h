#pragma once
// How many pairs and contacts a step will find, from a sample of its bodies against all others. The same
// sample for the same bodies, whatever runs it. Free functions over plain data.

#include <cstdint>
#include <vector>

#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/core/parallel_for.h"

namespace collidoscope {

/// Spheres, and what a step foresees of their motion (narrow_phase/sphere_sphere.h).
struct MovingSpheres {
  std::vector<Vector3d> position;  ///< m
  std::vector<double> radius;      ///< m
  std::vector<Vector3d> velocity;  ///< m/s, or empty: all at rest
  double time = 0;                 ///< s; 0: nothing is foreseen
  double acceleration_margin = 0;  ///< m
  bool anywhere = false;           ///< they may turn: continuous collision
};

struct SampledPairs {
  double pairs = 0, contacts = 0;  ///< of all bodies
};

/// `samples` bodies, or all where they are no more. Takes samples x N tests of boxes. Throws Cancelled.
SampledPairs sample_pairs(ThreadTeam& team, const MovingSpheres& spheres, std::int64_t samples);

}  // namespace collidoscope

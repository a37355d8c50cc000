#pragma once
// Estimates the number of pairs and contacts of a step by testing a sample of bodies against all others.
// The sample depends only on the bodies, so the estimate is the same on every executor. Free functions over
// plain data.

#include <cstdint>
#include <vector>

#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/core/parallel_for.h"
#include "sim_cuda/narrow_phase/sphere_sphere.h"

namespace collidoscope {

/// Spheres and their motion in a step, for speculative contacts.
struct MovingSpheres {
  std::vector<Vector3d> position;         ///< m
  std::vector<double> radius;             ///< m
  std::vector<Vector3d> velocity;         ///< m/s; empty: all at rest
  SpeculativeMargin<double> margin = {};  ///< without velocities
  bool moves_anywhere() const { return margin.bound == MotionBound::any_direction; }
};

struct SampledPairs {
  double pairs = 0, contacts = 0;  ///< estimate for all bodies
};

/// Tests `samples` bodies, or all if there are fewer. Costs samples x N box tests. Throws Cancelled.
SampledPairs sample_pairs(ThreadTeam& team, const MovingSpheres& spheres, std::int64_t samples);

}  // namespace collidoscope

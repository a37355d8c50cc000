#pragma once
// Sums over all bodies at one state: energy, momenta, extremes, and the hash by which runs are compared. In
// double, in the fixed order of core/reduce.h, so that they too are the same everywhere.

#include <cstdint>
#include <optional>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/dynamics/attractor.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/measure/step_stats.h"
#include "sim_cuda/narrow_phase/contact_list.h"
#include "sim_cuda/scene/scene.h"
#include "sim_cuda/solver/box_surface.h"
#include "sim_cuda/solver/contact_impulses.h"
#include "sim_cuda/solver/joint_measure.h"
#include "sim_cuda/solver/sleeping.h"
#include "sim_cuda/solver/walls.h"

namespace collidoscope {

struct BodySums {
  double kinetic, potential;            ///< J
  Vector3d momentum, angular_momentum;  ///< kg m/s; kg m^2/s about the origin
  double wall_impulse;                  ///< N s
  Vector3d wall_vector;                 ///< N s
  double push_work;                     ///< J
  double max_speed_squared;             ///< m^2/s^2
  double max_depth;                     ///< m, into walls
  std::int64_t non_finite, escaped;
};
struct Largest {
  double value;
};
struct HashSum {
  std::uint64_t value;
};

/// What is measured. All pointers are in the executor's memory.
template <class Real>
struct MeasureSource {
  BodyView<Real> bodies;
  std::int64_t body_count;
  const StaticImpulse* static_impulses;  ///< null where there are no walls
  const WallPlane<Real>* planes;
  int plane_count;
  BoxView<Real> boxes;
  Vector3d gravity;  ///< m/s^2
  AttractorView<Real> attractors;
  std::optional<Box> box;
  ContactView<Real> contacts;  ///< of the current state
  const StepControl* control;
  std::int64_t contact_capacity;
  ImpulseView<Real> impulses;  ///< of the last step
};

/// Adds what joints, `count` of them, and sleepers say of the state.
void add(const JointSums& sums, std::int64_t count, StepStats& stats);
void add(const SleepSums& sums, StepStats& stats);

/// Owns the scratch of the sums; one per world. Both calls wait for the device.
template <class Real>
class Measurer {
 public:
  explicit Measurer(Executor& executor);
  /// Outside of a step, whenever a capacity changed.
  void reserve(std::int64_t bodies, std::int64_t contact_capacity);
  /// Fills all of `stats` but the counts of the step. No bodies: leaves it as it is.
  void measure(const MeasureSource<Real>& source, StepStats& stats);
  /// A sum modulo 2^64 over bodies of a mix of (id, x, q, v, w as bits), so that it does not depend on order.
  /// Quantities that are not stored count as q = 1, w = 0; no bodies: 0.
  std::uint64_t state_hash(const BodyView<Real>& bodies, std::int64_t body_count);

 private:
  Executor& executor_;
  Buffer<BodySums> sums_;
  Buffer<Largest> largest_;
  Buffer<HashSum> hashes_;
};

}  // namespace collidoscope

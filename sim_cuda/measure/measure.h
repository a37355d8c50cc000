#pragma once
// Sums over all bodies at one state: energy, momenta, maxima, and the state hash. Computed in double in the
// fixed order of core/reduce.h, so the results are the same on every executor.

#include <cstdint>
#include <optional>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/hashed_arrays.h"
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
  Vector3d momentum, angular_momentum;  ///< kg m/s; about the origin, kg m^2/s
  double wall_impulse;                  ///< N s
  Vector3d wall_vector;                 ///< N s
  double push_work;                     ///< J
  double max_speed_squared;             ///< m^2/s^2
  double max_depth;                     ///< into walls, m
  std::int64_t non_finite, escaped;
};
struct Largest {
  double value;
};
struct HashSums {
  std::uint64_t bodies, others;
};

/// Data of a world to be measured, in the executor's memory.
template <class Real>
struct MeasureSource {
  BodyView<Real> bodies;
  std::int64_t body_count;
  const StaticImpulse* static_impulses;  ///< null without walls
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

/// Adds the sums of `count` joints, or of sleeping bodies, to `stats`.
void add(const JointSums& sums, std::int64_t count, StepStats& stats);
void add(const SleepSums& sums, StepStats& stats);

/// Owns the scratch buffers of the sums; one per world. measure() waits for the device.
template <class Real>
class Measurer {
 public:
  explicit Measurer(Executor& executor);
  /// Call outside of steps, after each change of a capacity.
  void reserve(std::int64_t bodies, std::int64_t contact_capacity);
  /// Fills `stats` except the counts of the step. Without bodies, `stats` stays unchanged.
  void measure(const MeasureSource<Real>& source, StepStats& stats);
  /// Launches a stage that adds hashes to two sums, modulo 2^64. The first one: over the bodies, of
  /// (id, x, q, v, w as bits). Quantities that are not stored count as q = 1, w = 0. The second one: of
  /// `low`, which the angular velocities lack (wide_spin.h; may be null), and of `others`. Does not wait.
  void add_hashes(const char* stage, const BodyView<Real>& bodies, std::int64_t body_count,
                  const Vector3<float>* low, const HashedArrays& others, std::uint64_t* sums);

 private:
  Executor& executor_;
  Buffer<BodySums> sums_;
  Buffer<Largest> largest_;
};

}  // namespace collidoscope

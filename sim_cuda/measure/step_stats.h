#pragma once
// What a run reports: plain data, SI units, read by panels, JSON and tests alike. No CUDA, no GL.

#include <cstdint>
#include <string>
#include <vector>

#include "sim_cuda/core/stage_launch.h"

namespace collidoscope {

/// Sums over all bodies at one state, and counts of the last step.
struct StepStats {
  std::int64_t step = 0;  ///< states are numbered by the steps that led to them
  std::int64_t bodies = 0;
  std::int64_t pairs = 0;     ///< boxes that overlap, last step (before the first step: as found there)
  std::int64_t touching = 0;  ///< pairs whose shapes touch (gap <= 0) at this state
  /// Contacts of the last step: pairs that touched at its start, or that its motion could bring together.
  /// Before the first step: as touching. With the solver impulse: of the last substep, without a margin.
  std::int64_t speculative = 0;
  std::int64_t split_contacts = 0;  ///< contacts that the colours left over, solved by mass splitting
  double kinetic_energy = 0;        ///< J, translation and rotation
  double potential_energy = 0;      ///< J, zero at z = box.min.z (or z = 0 without a box)
  double push_work = 0;             ///< J, potential energy added by the positional push since the start
  double momentum[3] = {};          ///< kg m/s
  double angular_momentum[3] = {};  ///< kg m^2/s about the origin
  double wall_impulse = 0;  ///< N s, sum of normal impulses given to walls and obstacles since the start
  double wall_impulse_vector[3] = {};  ///< N s, what walls and obstacles gave to the bodies, as a vector
  double max_penetration = 0;          ///< m, deepest overlap of two bodies or body and wall at this state
  double max_speed = 0;                ///< m/s
  double max_impulse = 0;              ///< N s, of a contact in the last step; 0 where it is not recorded
  std::int64_t joints = 0;             ///< that are simulated
  double max_joint_error = 0;          ///< m, that what a joint holds is too far apart, or too near
  double max_joint_angle = 0;          ///< rad, about: between a hinge's axes, or beyond its limits
  double spring_energy = 0;            ///< J, of joints; part of the potential energy
  bool can_sleep = false;              ///< the scene calls for sleeping; else the next three are 0
  std::int64_t asleep = 0;             ///< bodies that slept in the last step
  std::int64_t islands = 0;            ///< of bodies that forces move, in the last step; one may be alone
  std::int64_t islands_asleep = 0;     ///< of these
  std::int64_t non_finite = 0;         ///< bodies with a component that is not finite
  std::int64_t escaped = 0;            ///< centres outside the box
  double energy() const { return kinetic_energy + potential_energy; }
};

/// One stage's cost over the steps measured so far.
struct StageTime {
  std::string name;  ///< the same in profiler, NVTX, graphs and exports
  double median_ms = 0, p95_ms = 0, last_ms = 0;
  int launches = 0;        ///< kernels per step (CPU: parallel loops)
  bool own_shape = false;  ///< part of it runs in a library that ignores (B, T)
  StageLaunch launch{};    ///< what the rest of it was launched as
  int samples = 0;         ///< steps that were timed; 0: the times are not known
};

/// Times of the whole step come from plain steps, times of stages from instrumented ones; they are never
/// mixed.
struct RunTimes {
  double step_median_ms = 0, step_p95_ms = 0;  ///< 0 while no plain step was timed
  double step_last_ms = 0;                     ///< the newest of them
  int steps_timed = 0;
  std::vector<StageTime> stages;  ///< in the order of the pipeline
};

/// How long the broad phase of one state takes, ms.
struct BroadPhaseTimes {
  std::vector<float> whole;  ///< each repeat, nothing measured within
  struct Stage {
    std::string name;
    std::vector<float> ms;  ///< each repeat
    int launches = 0;
    bool own_shape = false;
  };
  std::vector<Stage> stages;  ///< of other repeats, with a time taken after each stage
};

}  // namespace collidoscope

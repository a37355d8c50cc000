#pragma once
// What a run reports of a state: plain data, SI units, read by panels, JSON and tests alike. No CUDA, no GL.

#include <cstdint>

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
  std::int64_t uncoloured_contacts = 0;  ///< contacts that the colours left over, solved by mass splitting
  double kinetic_energy = 0;             ///< J, translation and rotation
  double potential_energy = 0;           ///< J, zero at z = box.min.z (or z = 0 without a box)
  double push_work = 0;                  ///< J, potential energy added by the positional push since the start
  double momentum[3] = {};               ///< kg m/s
  double angular_momentum[3] = {};       ///< kg m^2/s about the origin
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

}  // namespace collidoscope

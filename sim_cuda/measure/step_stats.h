#pragma once
// Measurements of a state, for panels, JSON and tests. Plain data, SI units, without CUDA or GL.

#include <cstdint>

namespace collidoscope {

/// Sums over all bodies at one state, and counts of the last step.
struct StepStats {
  std::int64_t step = 0;  ///< number of the state: steps since state 0
  std::int64_t bodies = 0;
  std::int64_t pairs = 0;     ///< overlapping boxes in the last step; before the first step, at this state
  std::int64_t touching = 0;  ///< pairs with gap <= 0 at this state
  /// Contacts of the last step, including speculative ones. Before the first step: equal to touching. With
  /// the solver impulse: contacts of the last substep, without speculative ones.
  std::int64_t speculative = 0;
  std::int64_t bounce_cap = 0;  ///< substeps of the last step with impacts left after the last impact sweep
  std::int64_t uncoloured_contacts = 0;  ///< contacts without a colour, solved by mass splitting
  double kinetic_energy = 0;             ///< translation and rotation, J
  double potential_energy = 0;           ///< J; zero at z = box.min.z, or at z = 0 without a box
  double push_work = 0;                  ///< potential energy added by overlap recovery since state 0, J
  double momentum[3] = {};               ///< kg m/s
  double angular_momentum[3] = {};       ///< about the origin, kg m^2/s
  double wall_impulse = 0;               ///< sum of normal impulses on walls and obstacles since state 0, N s
  double wall_impulse_vector[3] = {};    ///< vector sum of impulses by walls and obstacles on bodies, N s
  double max_penetration = 0;       ///< largest overlap of two bodies or of body and wall at this state, m
  double max_speed = 0;             ///< m/s
  double max_impulse = 0;           ///< largest contact impulse in the last step, N s; 0 if not recorded
  std::int64_t joints = 0;          ///< number of simulated joints
  double max_joint_error = 0;       ///< largest anchor distance outside the allowed range, m
  double max_joint_angle = 0;       ///< largest approximate angle between hinge axes or beyond limits, rad
  double spring_energy = 0;         ///< energy of springs, J; part of potential_energy
  bool can_sleep = false;           ///< the scene has sleeping; otherwise the next three are 0
  std::int64_t asleep = 0;          ///< bodies asleep in the last step
  std::int64_t islands = 0;         ///< islands of dynamic bodies in the last step, including single bodies
  std::int64_t islands_asleep = 0;  ///< sleeping islands
  std::int64_t non_finite = 0;      ///< bodies with a non-finite component
  std::int64_t escaped = 0;         ///< bodies whose centre is outside the box
  double energy() const { return kinetic_energy + potential_energy; }
};

}  // namespace collidoscope

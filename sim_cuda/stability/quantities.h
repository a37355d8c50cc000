#pragma once
// Definitions of the quantities of a criterion. Stateless functions that measure an observation.
//
// finite                   number of bodies with a non-finite component
// penetration              m, deepest overlap of two bodies, or of a body and a wall (StepStats)
// penetration_over_radius  largest overlap over the radius; the smaller radius of two bodies
// speed, angular_speed     m/s, rad/s, of each body
// energy_gain              (E - E0 - W) / S. E is kinetic plus potential energy, W the work of the
//                          positional push since the start. S is the largest kinetic energy + |change of
//                          potential energy| of the states measured so far. 0 if numerator and S are 0
// energy_loss              -energy_gain
// kinetic_energy           J
// escaped                  number of bodies with their centre outside the box
// displacement             m, of each body since state `since`; bodies of both states
// position, velocity       m, m/s, along `axis`, of each body
// momentum_change          |p - p0 - J - m g t| / S. J is the impulse of the walls, m the mass of all
//                          dynamic bodies, S the largest sum of m |v| so far
// angular_momentum_change  |L - L0| / S about the origin. S is the largest so far of |L| and of the sum of
//                          m |v| times the largest distance of a body from the centre of all
// quaternion_norm          | |q| - 1 |, of each body
// joint_error, joint_angle m, rad, maximum (StepStats)
// pairs, touching, speculative, asleep  counts (StepStats)
// tree_depth               levels of the broad phase's tree; 0 without a tree
// separation_speed         m/s, of two bodies that overlapped at the first state; along z if their centres
//                          coincide
//
// `difference` and `other_hash` need other runs. `found` is 1 if guards report exactly the expected finding,
// else 0. test_run.h implements these three.

#include <cstdint>
#include <optional>

#include "sim_cuda/stability/observation.h"

namespace collidoscope {

/// Minimum and maximum over all bodies, and the bodies that have them; equal for a single number. A NaN sets
/// both permanently. Without values, both are 0.
struct Extremes {
  double min = 0, max = 0;
  std::optional<std::uint32_t> min_body{}, max_body{};
  bool any = false;

  void add(double value, std::optional<std::uint32_t> body = std::nullopt);
};

/// Measures the observed state. The quantity must not be one of the three above.
Extremes measured(const Assertion& assertion, Observation& observation);
/// Distance of each body from its counterpart in `other`, shifted by the assertion's offset.
Extremes difference(const Assertion& assertion, const BodyStates& bodies, const BodyStates& other);

/// The body that violates an assertion whose measured() reports none: penetrations, escapes and non-finite
/// bodies.
std::optional<std::uint32_t> offending_body(const Assertion& assertion, Observation& observation);

}  // namespace collidoscope

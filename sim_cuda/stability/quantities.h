#pragma once
// How each quantity of a criterion is measured at a state. Free functions over an observation.
//
//   finite                   bodies with a component that is not finite
//   penetration              m, the deepest overlap of two bodies, or of a body and a wall (StepStats)
//   penetration_over_radius  the largest overlap over the radius, of two bodies over that of the smaller one
//   speed, angular_speed     m/s, rad/s, of each body
//   energy_gain              (E - E0 - W) / S: E is kinetic and potential energy, W the work of the
//                            positional push since the start, S the largest kinetic energy + |change of the
//                            potential energy| of the states measured so far; 0 where both are 0
//   energy_loss              the same, negated
//   kinetic_energy           J
//   escaped                  bodies whose centres are outside the box
//   displacement             m, of each body from where it was at state `since`; bodies of both states
//   position, velocity       m, m/s, along `axis`, of each body
//   momentum_change          |p - p0 - J - m g t| / S: J is what walls gave, m the mass of all that forces
//                            move, S the largest sum of m |v| so far
//   angular_momentum_change  |L - L0| / S about the origin, S the largest |L| so far, or sum of m |v| times
//                            the farthest that a body reaches from the middle of all
//   quaternion_norm          | |q| - 1 |, of each body
//   joint_error, joint_angle m, rad, the largest (StepStats)
//   pairs, touching, speculative, asleep  counts (StepStats)
//   tree_depth               levels of the tree that the broad phase has; 0 without one
//   separation_speed         m/s, at which two bodies part that overlapped at the first state; along z where
//                            their centres coincide
// `difference` and `other_hash` need other runs, `found` is 1 where guards found what they must and nothing
// else, or 0: test_run.h.

#include <cstdint>
#include <optional>

#include "sim_cuda/stability/observation.h"

namespace collidoscope {

/// The least and the most of all bodies, and whose they are; the same where it is one number. A value that is
/// NaN is both, from then on. Without values, both are 0.
struct Extremes {
  double min = 0, max = 0;
  std::optional<std::uint32_t> min_body{}, max_body{};
  bool any = false;

  void add(double value, std::optional<std::uint32_t> body = std::nullopt);
};

/// Of the state that is observed; the assertion is none of those three.
Extremes measured(const Assertion& assertion, Observation& observation);
/// How far each body is from where `other` has it, and the assertion's offset.
Extremes difference(const Assertion& assertion, const BodyStates& bodies, const BodyStates& other);

/// Whose fault it is, where measured() does not say: of penetrations, escapes and what is not finite.
std::optional<std::uint32_t> offending_body(const Assertion& assertion, Observation& observation);

}  // namespace collidoscope

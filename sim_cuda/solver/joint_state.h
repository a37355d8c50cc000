#pragma once
// A joint as the stages of `soft_step` see it: what it is, which no run changes, and what it gives, which
// lives on from substep to substep.

#include <cstdint>

#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/scene/joint.h"

namespace collidoscope {

/// Whether an iteration comes before bodies move or after.
enum class JointPhase { solve, relax };

/// How hard a joint works against its error C (m) while it is solved: the impulse so far, p, changes by
/// -mass (mass_scale speed + bias_rate C) - impulse_scale p. Rigid: 1, 1/h, 0.
template <class Real>
struct JointStiffness {
  Real mass_scale;
  Real bias_rate;  ///< 1/s
  Real impulse_scale;
  Real warm_start_factor;  ///< of the impulse of the substep before, as a start
};

template <class Real>
struct JointRow {
  static constexpr std::uint32_t world = 0xffffffffu;

  std::uint32_t a, b;  ///< ids; b: or `world`
  JointKind kind;
  bool limited;  ///< a hinge with limits
  Vector3<Real> anchor_a,
      anchor_b;  ///< m, along principal axes from the centre; a place, where b is the world
  JointStiffness<Real> stiffness;
  Real max_correction_speed;                       ///< m/s, at which an error goes
  static constexpr Real max_correction_rate = 50;  ///< rad/s, at which axes come together
  Real low, high;                                  ///< m, of a distance; a rod's and a spring's are equal
  Real spring;                                     ///< 1/s^2, stiffness of a spring over its mass
  Vector3<Real> axis_a, axis_b, side;  ///< of a hinge, along principal axes; side: of a, across the axis
  Quaternion<Real> start;              ///< turns b's principal axes into a's where the hinge's angle is 0
  Real low_cosine, low_sine, high_cosine, high_sine;  ///< of half the angles of the limits
};

/// What a joint gives to b and takes from a. 32 bytes in float.
template <class Real>
struct alignas(4 * sizeof(Real)) JointImpulse {
  Vector3<Real> linear;   ///< N s; of a rod or spring, x: along it, > 0 apart
  Real lower, upper;      ///< of limits, >= 0; N s of a distance, N m s of a hinge
  Real perpendicular[2];  ///< N m s, of a hinge, across its axis
};
static_assert(sizeof(JointImpulse<float>) == 32 && sizeof(JointImpulse<double>) == 64);

/// All joints, colour by colour: no two of a colour share a body that moves.
template <class Real>
struct JointView {
  const JointRow<Real>* rows = nullptr;
  JointImpulse<Real>* impulses = nullptr;
  const std::uint32_t* begin = nullptr;  ///< of each colour, and the end
  std::int64_t count = 0;
};

}  // namespace collidoscope

#pragma once
// Data of a joint in `soft_step`: constant parameters (JointRow), and accumulated impulses (JointImpulse),
// which are kept from substep to substep. Plain data.

#include <cstdint>

#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/scene/joint.h"

namespace collidoscope {

/// Position of an iteration in the substep: solve and correct before bodies move, relax after. Correct
/// computes velocities that remove position errors and end with the move.
enum class JointPhase { solve, correct, relax };

/// Softness of a joint with error C (m) in solve. The accumulated impulse p changes by -mass (mass_scale
/// speed + bias_rate C) - impulse_scale p. Rigid: 1, 1/h, 0. For a spring, C is multiplied by the effective
/// mass at time zero over the present one, so that its stiffness is constant.
template <class Real>
struct JointStiffness {
  Real mass_scale;
  Real bias_rate;  ///< 1/s
  Real impulse_scale;
  Real warm_start_factor;  ///< fraction of the last substep's impulse
};

template <class Real>
struct JointRow {
  static constexpr std::uint32_t world = 0xffffffffu;

  std::uint32_t a, b;  ///< body ids; b may be `world`
  JointKind kind;
  bool limited;  ///< hinge with limits
  Vector3<Real> anchor_a,
      anchor_b;  ///< in principal axes from the centre, m; anchor_b is a world position if b is `world`
  JointStiffness<Real> stiffness;
  Real max_correction_speed;                       ///< upper limit of the correction speed, m/s
  static constexpr Real max_correction_rate = 50;  ///< upper limit of the axis correction, rad/s
  Real low, high;           ///< allowed distance, m; equal for a rod and for a spring's rest length
  Real spring;              ///< stiffness, N/m, of a spring; else 0
  Real start_inverse_mass;  ///< 1/kg, of a spring: sum of its anchors' inverse effective masses at time zero
  Vector3<Real> axis_a, axis_b, side;  ///< of a hinge, in principal axes; side: perpendicular to a's axis
  Quaternion<Real> start;              ///< rotation from b's to a's principal axes at hinge angle 0
  Real low_cosine, low_sine, high_cosine, high_sine;  ///< of half the limit angles
};

/// Accumulated impulse of a joint, applied to b and negative to a. 32 bytes in float.
template <class Real>
struct alignas(4 * sizeof(Real)) JointImpulse {
  Vector3<Real> linear;   ///< N s; rod and spring: x only, along the line, > 0 pushes apart
  Real lower, upper;      ///< limits, >= 0; N s for a distance, N m s for a hinge
  Real perpendicular[2];  ///< hinge: perpendicular to its axis, N m s
};
static_assert(sizeof(JointImpulse<float>) == 32 && sizeof(JointImpulse<double>) == 64);

/// All joints, sorted by colour. No two joints of a colour share a dynamic body.
template <class Real>
struct JointView {
  const JointRow<Real>* rows = nullptr;
  JointImpulse<Real>* impulses = nullptr;
  const std::uint32_t* begin = nullptr;  ///< start of each colour, and the end
  std::int64_t count = 0;
};

}  // namespace collidoscope

#pragma once
// Position error of a joint at the current state, for reports and displays. Pure functions.

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/solver/joint_ends.h"

namespace collidoscope {

/// Maxima (errors) and sum (energy) over joints.
struct JointSums {
  double error;   ///< anchor distance outside the allowed range, m
  double angle;   ///< approximate angle between the hinge axes or beyond the limits, rad
  double energy;  ///< potential energy of springs, J
};

SIM_HD inline JointSums combine(const JointSums& a, const JointSums& b) {
  return {max_of(a.error, b.error), max_of(a.angle, b.angle), a.energy + b.energy};
}

/// Remaining angles of a hinge to its limits, rad, as twice the sine of half the angle; < 0 beyond a limit.
template <class Real>
struct HingeLimitGap {
  Real above, below;
  Real above_slope, below_slope;  ///< d above / d angle and -d below / d angle
  SIM_HD HingeLimitGap(const JointRow<Real>& joint, const Quaternion<Real>& axes_a,
                       const Quaternion<Real>& axes_b) {
    const Quaternion<Real> twist = axes_a.conjugate() * axes_b * joint.start.conjugate();
    Real cosine = twist.w(), sine = twist.vec().dot(joint.axis_a);  // of half the angle
    if (cosine < 0) {
      cosine = -cosine;
      sine = -sine;
    }
    above = 2 * (sine * joint.low_cosine - cosine * joint.low_sine);
    below = 2 * (joint.high_sine * cosine - joint.high_cosine * sine);
    above_slope = cosine * joint.low_cosine + sine * joint.low_sine;
    below_slope = cosine * joint.high_cosine + sine * joint.high_sine;
  }
};

template <class Real, bool with_rotation>
SIM_HD JointSums measure_joint(const BodyView<Real>& bodies, const JointRow<Real>& joint) {
  const JointEnds<Real, with_rotation> ends(bodies, joint);
  using std::sqrt;
  const Real length = sqrt(ends.separation.dot(ends.separation));
  JointSums sums{0, 0, 0};
  if (joint.kind == JointKind::distance) {
    sums.error = static_cast<double>(max_of(Real(0), max_of(joint.low - length, length - joint.high)));
  } else if (joint.kind == JointKind::spring) {
    const auto stretch = static_cast<double>(length - joint.low);
    sums.energy = static_cast<double>(joint.spring) * stretch * stretch / 2;
  } else {
    sums.error = static_cast<double>(length);
  }
  if constexpr (with_rotation) {
    if (joint.kind != JointKind::hinge) return sums;
    const Vector3<Real> between = (ends.a.axes * joint.axis_a).cross(ends.b.axes * joint.axis_b);
    Real angle = sqrt(between.dot(between));
    if (joint.limited) {
      const HingeLimitGap<Real> gap(joint, ends.a.axes, ends.b.axes);
      angle = max_of(angle, max_of(-gap.above, -gap.below));
    }
    sums.angle = static_cast<double>(angle);
  }
  return sums;
}

}  // namespace collidoscope

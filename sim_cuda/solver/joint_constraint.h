#pragma once
// What one joint does to its two bodies. Called for by a scene's list of joints.
//
// Solving looks at where the anchors will be when the substep has moved them, curvature included; relaxing,
// after the move, leaves them no speed against each other. For a joint by itself this is RATTLE (Andersen
// 1983) with the kick in front: the period is right to second order in h, and energy does not drift. Where
// bodies have n > 1 joints, these are iterated (Gauss, Seidel) and yield: 0.4/n of an error is pulled in per
// substep, and a tenth of the impulse that was carried over is let go of. A load F at rest makes such a joint
// give way by F h^2 n / (4 m), m being the mass that it feels, and some four times that when it swings; asked
// for faster, what the sweeps have
// not passed on yet would be asked for twice, and swing up. Errors go at no more than 50 radii of the smaller
// body a second. Impulses act in pairs along one line or at one place: momenta are kept to rounding.
//
// A spring is solved once a substep, by an impulse that depends on stretch and speed just so that a pair by
// itself swings as the closed form does, whatever h: x'' = -w^2 x - 2 z w x', sampled every h, has the roots
// p = exp(h w (-z +- sqrt(z^2 - 1))), and so has the substep v' = v - mass_scale v - bias_rate x, x' = x + h
// v' with mass_scale = 1 - p1 p2 and bias_rate = (1 - p1) (1 - p2) / h. (v is without what the spring gives,
// so impulse_scale = 1 - mass_scale.) Stretch acts explicitly. For nets of springs to be stable, h w counts
// as no more than 1 / sqrt(n): then none of a net's frequencies is above sqrt(2) / h (Gershgorin), and 2 / h
// is the limit.

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/solver/friction.h"
#include "sim_cuda/solver/joint_measure.h"

namespace collidoscope {

template <class Real, bool with_rotation>
struct JointConstraint {
  const JointRow<Real>& joint;
  JointImpulse<Real>& accumulated;
  JointEnds<Real, with_rotation>& ends;
  Real h;  ///< s, of a substep

  SIM_HD JointConstraint(const JointRow<Real>& row, JointImpulse<Real>& impulse,
                         JointEnds<Real, with_rotation>& both, Real substep)
      : joint(row), accumulated(impulse), ends(both), h(substep) {}

  SIM_HD void warm_start() {
    if (rotates_too_fast(ends.a) || rotates_too_fast(ends.b)) {
      accumulated = {Vector3<Real>::Zero(), 0, 0, {0, 0}};
      return;
    }
    const Real warm_start_factor = joint.stiffness.warm_start_factor;
    accumulated.linear *= warm_start_factor;
    accumulated.lower *= warm_start_factor;
    accumulated.upper *= warm_start_factor;
    if (joint.kind == JointKind::ball || joint.kind == JointKind::hinge) {
      apply_point_impulse(accumulated.linear);
      if constexpr (with_rotation)
        if (joint.kind == JointKind::hinge) {
          const Hinge hinge(*this);
          accumulated.perpendicular[0] *= warm_start_factor;
          accumulated.perpendicular[1] *= warm_start_factor;
          apply_angular_impulse(accumulated.perpendicular[0] * hinge.side +
                                accumulated.perpendicular[1] * hinge.other +
                                (accumulated.lower - accumulated.upper) * hinge.axis);
        }
    } else {
      const Real length = length_of(ends.separation);
      apply_impulse_along(direction(length), accumulated.linear.x() + accumulated.lower - accumulated.upper);
    }
  }

  template <JointPhase phase>
  SIM_HD void iterate() {
    if (joint.kind == JointKind::distance || joint.kind == JointKind::spring) return solve_line<phase>();
    if constexpr (with_rotation)
      if (joint.kind == JointKind::hinge) solve_hinge<phase>();
    solve_point<phase>();
  }

 private:
  /// It turns so far in a substep, by half a radian, that an impulse of the substep before is none for this
  /// one: carried over all the same, joints that contradict each other would bring energy without end.
  SIM_HD bool rotates_too_fast(const JointEnd<Real, with_rotation>& end) const {
    if constexpr (with_rotation) return h * h * end.angular_velocity.dot(end.angular_velocity) > Real(0.25);
    return false;
  }
  static SIM_HD Real length_of(const Vector3<Real>& v) {
    using std::sqrt;
    return sqrt(v.dot(v));
  }
  /// From a's anchor to b's; up, where they are in one place.
  SIM_HD Vector3<Real> direction(Real length) const {
    return length > 0 ? Vector3<Real>(ends.separation / length) : Vector3<Real>(0, 0, 1);
  }
  static SIM_HD Real inverse(Real inverse_mass) { return inverse_mass > 0 ? 1 / inverse_mass : Real(0); }
  SIM_HD void apply_impulse_along(const Vector3<Real>& normal, Real impulse) {
    const Vector3<Real> vector = impulse * normal;
    ends.b.apply_impulse(vector, ends.b.arm);
    ends.a.apply_impulse(-vector, ends.a.arm);
  }
  SIM_HD void apply_angular_impulse(const Vector3<Real>& impulse) {
    ends.b.apply_angular_impulse(impulse);
    ends.a.apply_angular_impulse(-impulse);
  }

  SIM_HD Real clamp_speed(Real speed) const {
    return clamp_to(speed, -joint.max_correction_speed, joint.max_correction_speed);
  }
  /// What is held from both sides: the new part of `impulse`.
  template <JointPhase phase>
  SIM_HD Real bilateral_impulse(Real error, Real speed, Real mass, Real impulse) const {
    const JointStiffness<Real>& s = joint.stiffness;
    if (phase == JointPhase::relax) return -mass * speed;
    const Real bias =
        joint.kind == JointKind::spring ? s.bias_rate * error : clamp_speed(s.bias_rate * error);
    return -mass * (s.mass_scale * speed + bias) - s.impulse_scale * impulse;
  }
  /// What is held from one side, by a gap that `speed` opens; < 0: too far. May close, and not more.
  template <JointPhase phase>
  SIM_HD Real unilateral_impulse(Real gap, Real speed, Real mass, Real& impulse) const {
    if (phase == JointPhase::relax && gap > 0 && !(impulse > 0)) return 0;
    const Real change =
        gap > 0 ? -mass * (speed + gap / h) : bilateral_impulse<phase>(gap, speed, mass, impulse);
    const Real next = max_of(impulse + change, Real(0)), applied = next - impulse;
    impulse = next;
    return applied;
  }

  // ---- along the line from anchor to anchor ----

  template <JointPhase phase>
  SIM_HD void solve_line() {
    const bool spring = joint.kind == JointKind::spring;
    if (phase == JointPhase::relax && spring) return;
    const Real length = length_of(ends.separation);
    const Vector3<Real> normal = direction(length);
    const Real inverse_mass =
        ends.a.inverse_effective_mass(normal, ends.a.arm) + ends.b.inverse_effective_mass(normal, ends.b.arm);
    const Real mass = inverse(inverse_mass);
    Real speed = (ends.b.velocity_at(ends.b.arm) - ends.a.velocity_at(ends.a.arm)).dot(normal);
    if constexpr (phase == JointPhase::solve) {
      const Vector3<Real> mean =
          ends.b.mean_velocity_at(ends.b.arm, h) - ends.a.mean_velocity_at(ends.a.arm, h);
      const Vector3<Real> then = ends.separation + h * mean;
      if (ends.separation.dot(then) > 0)  // else it passes through 0, which is no curve
        speed += clamp_speed(mean.dot(ends.separation + then) / (length + length_of(then)) - speed);
    }
    Real change = 0;
    if (joint.low == joint.high) {
      change = bilateral_impulse<phase>(length - joint.low, speed, mass, accumulated.linear.x());
      accumulated.linear.x() += change;
    } else {
      if (joint.low > 0)
        change += unilateral_impulse<phase>(length - joint.low, speed, mass, accumulated.lower);
      if (finite(joint.high))
        change -= unilateral_impulse<phase>(joint.high - length, -(speed + change * inverse_mass), mass,
                                            accumulated.upper);
    }
    apply_impulse_along(normal, change);
  }

  // ---- one point in common ----

  // Impulses act midway between the anchors, on both bodies at one place, so that they keep the angular
  // momentum.
  SIM_HD Vector3<Real> arm_a() const {
    return joint.b == JointRow<Real>::world ? ends.a.arm : Vector3<Real>(ends.a.arm + ends.separation / 2);
  }
  SIM_HD Vector3<Real> arm_b() const { return ends.b.arm - ends.separation / 2; }
  SIM_HD void apply_point_impulse(const Vector3<Real>& impulse) {
    ends.b.apply_impulse(impulse, arm_b());
    ends.a.apply_impulse(-impulse, arm_a());
  }

  template <JointPhase phase>
  SIM_HD void solve_point() {
    Symmetric3<Real> inverse_mass;
    ends.a.add_inverse_mass_matrix(arm_a(), inverse_mass);
    ends.b.add_inverse_mass_matrix(arm_b(), inverse_mass);
    Vector3<Real> velocity_error = ends.b.velocity_at(arm_b()) - ends.a.velocity_at(arm_a());
    if constexpr (phase == JointPhase::solve) {
      const Vector3<Real> mean =
          ends.b.mean_velocity_at(ends.b.arm, h) - ends.a.mean_velocity_at(ends.a.arm, h);
      velocity_error += clamp_length<Real>(
          mean - velocity_error + joint.stiffness.bias_rate * ends.separation, joint.max_correction_speed);
    }
    const Vector3<Real> change = -inverse_mass.solve(velocity_error);
    accumulated.linear += change;
    apply_point_impulse(change);
  }

  // ---- one axis in common ----

  struct Hinge {
    Vector3<Real> axis, axis_b, side, other;  ///< world; axis, side and other are a's, right-handed
    SIM_HD explicit Hinge(const JointConstraint& work)
        : axis(work.ends.a.axes * work.joint.axis_a),
          axis_b(work.ends.b.axes * work.joint.axis_b),
          side(work.ends.a.axes * work.joint.side),
          other(axis.cross(side)) {}
  };

  template <JointPhase phase>
  SIM_HD void solve_hinge() {
    const Hinge frame(*this);
    if (joint.limited) {
      const Real mass = inverse(frame.axis.dot(ends.a.apply_inverse_inertia(frame.axis) +
                                               ends.b.apply_inverse_inertia(frame.axis)));
      const HingeLimitGap<Real> gap(joint, ends.a.axes, ends.b.axes);
      const auto rate = [&] { return (ends.b.angular_velocity - ends.a.angular_velocity).dot(frame.axis); };
      apply_angular_impulse(unilateral_impulse<phase>(gap.above, rate(), mass, accumulated.lower) *
                            frame.axis);
      apply_angular_impulse(-unilateral_impulse<phase>(gap.below, -rate(), mass, accumulated.upper) *
                            frame.axis);
    }
    const Vector3<Real> angular_side =
        ends.a.apply_inverse_inertia(frame.side) + ends.b.apply_inverse_inertia(frame.side);
    const Vector3<Real> angular_other =
        ends.a.apply_inverse_inertia(frame.other) + ends.b.apply_inverse_inertia(frame.other);
    const Real k00 = frame.side.dot(angular_side), k01 = frame.side.dot(angular_other),
               k11 = frame.other.dot(angular_other);
    const Vector3<Real> error = frame.axis.cross(frame.axis_b);
    Vector3<Real> velocity_error = ends.b.angular_velocity - ends.a.angular_velocity;
    if constexpr (phase == JointPhase::solve) {
      const Vector3<Real> a = ends.a.mean_rotation_velocity(frame.axis, h),
                          b = ends.b.mean_rotation_velocity(frame.axis_b, h);
      const Vector3<Real> mean = a.cross(frame.axis_b) + frame.axis.cross(b) + h * a.cross(b);
      const Vector3<Real> perpendicular = velocity_error - velocity_error.dot(frame.axis) * frame.axis;
      velocity_error += clamp_length<Real>(mean - perpendicular + joint.stiffness.bias_rate * error,
                                           joint.max_correction_rate);
    }
    const Real determinant = k00 * k11 - k01 * k01, scale = inverse(determinant);
    const Real along_side = velocity_error.dot(frame.side), along_other = velocity_error.dot(frame.other);
    const Real change_side = -scale * (k11 * along_side - k01 * along_other);
    const Real change_other = -scale * (k00 * along_other - k01 * along_side);
    accumulated.perpendicular[0] += change_side;
    accumulated.perpendicular[1] += change_other;
    apply_angular_impulse(change_side * frame.side + change_other * frame.other);
  }
};

}  // namespace collidoscope

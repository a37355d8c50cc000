#pragma once
// Constraint solver of one iterated joint: springs, and joints of groups with many loops. All others:
// joint_tree_solver.h.
//
// Solve removes the velocity errors of the joints, with the curvature of the move. Relax, after the move,
// removes the relative velocity of the anchors. Position errors are corrected separately, see joint_loops.h.
//
// Iterations start with the impulses of the last substep, so a static load is carried without error. Each
// substep corrects 0.8 of the position error, at no more than 50 radii of the smaller body per second.
// Impulses act in pairs along one line or at one point, so momenta are conserved to rounding.
//
// A spring is solved once per substep. Its impulse depends on stretch and speed so that a single pair
// follows the closed form for every h. Sampled every h, x'' = -w^2 x - 2 z w x' has the roots p = exp(h w
// (-z +- sqrt(z^2 - 1))). The substep v' = v - mass_scale v - bias_rate x, x' = x + h v' has the same roots
// with mass_scale = 1 - p1 p2 and bias_rate = (1 - p1) (1 - p2) / h. v excludes the spring's own impulse,
// so impulse_scale = 1 - mass_scale. Stretch acts explicitly. For stability of spring nets, h w is limited
// to 1 / sqrt(n). Then no frequency of a net exceeds sqrt(2) / h (Gershgorin); the stability limit is 2 /
// h.

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/solver/friction.h"
#include "sim_cuda/solver/joint_measure.h"

namespace collidoscope {

template <class Real, bool with_rotation>
struct JointConstraint {
  const JointRow<Real>& joint;
  JointImpulse<Real>& accumulated;
  JointEnds<Real, with_rotation>& ends;
  Real h;  ///< substep, s

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
  /// True if the body rotates by more than 0.5 rad per substep. The impulse direction of the last substep
  /// is then no longer valid, and warm starting with it would add energy in redundant joints.
  SIM_HD bool rotates_too_fast(const JointEnd<Real, with_rotation>& end) const {
    if constexpr (with_rotation) return h * h * end.angular_velocity.dot(end.angular_velocity) > Real(0.25);
    return false;
  }
  static SIM_HD Real length_of(const Vector3<Real>& v) {
    using std::sqrt;
    return sqrt(v.dot(v));
  }
  /// Unit vector from a's anchor to b's; (0, 0, 1) if they coincide.
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
  /// Two-sided constraint. Returns the change of the accumulated `impulse`.
  template <JointPhase phase>
  SIM_HD Real bilateral_impulse(Real error, Real speed, Real mass, Real impulse) const {
    const JointStiffness<Real>& s = joint.stiffness;
    if (phase == JointPhase::correct) return -mass * (speed + clamp_speed(s.bias_rate * error));
    if (phase == JointPhase::relax || joint.kind != JointKind::spring) return -mass * speed;
    return -mass * (s.mass_scale * speed + s.bias_rate * error) - s.impulse_scale * impulse;
  }
  /// One-sided constraint on a gap >= 0; `speed`: rate of the gap, > 0 opens. Updates the accumulated
  /// `impulse` and returns its change. A positive gap may close within the substep, but not become
  /// negative.
  template <JointPhase phase>
  SIM_HD Real unilateral_impulse(Real gap, Real speed, Real mass, Real& impulse) const {
    if (phase == JointPhase::correct)
      return gap < 0 ? max_of(bilateral_impulse<phase>(gap, speed, mass, impulse), Real(0)) : Real(0);
    if (phase == JointPhase::relax && gap > 0 && !(impulse > 0)) return 0;
    const Real change =
        gap > 0 ? -mass * (speed + gap / h) : bilateral_impulse<phase>(gap, speed, mass, impulse);
    const Real next = max_of(impulse + change, Real(0)), applied = next - impulse;
    impulse = next;
    return applied;
  }

  // ---- distance and spring: along the line between the anchors ----

  template <JointPhase phase>
  SIM_HD void solve_line() {
    const bool spring = joint.kind == JointKind::spring;
    if (phase != JointPhase::solve && spring) return;
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
      if (ends.separation.dot(then) > 0)  // otherwise the line passes through 0, where curvature is undefined
        speed += clamp_speed(mean.dot(ends.separation + then) / (length + length_of(then)) - speed);
    }
    Real change = 0;
    if (joint.low == joint.high) {
      Real error = length - joint.low;
      if (joint.start_inverse_mass > 0) error *= inverse_mass / joint.start_inverse_mass;
      change = bilateral_impulse<phase>(error, speed, mass, accumulated.linear.x());
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

  // ---- ball and hinge: one common point ----

  // Impulses act on both bodies midway between the anchors, so they conserve angular momentum.
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
      velocity_error += clamp_length<Real>(mean - velocity_error, joint.max_correction_speed);
    } else if constexpr (phase == JointPhase::correct) {
      velocity_error +=
          clamp_length<Real>(joint.stiffness.bias_rate * ends.separation, joint.max_correction_speed);
    }
    const Vector3<Real> change = -inverse_mass.solve(velocity_error);
    accumulated.linear += change;
    apply_point_impulse(change);
  }

  // ---- hinge: one common axis ----

  struct Hinge {
    Vector3<Real> axis, axis_b, side,
        other;  ///< world axes; axis, side and other are a's frame, right-handed
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
      velocity_error += clamp_length<Real>(mean - perpendicular, joint.max_correction_rate);
    } else if constexpr (phase == JointPhase::correct) {
      velocity_error += clamp_length<Real>(joint.stiffness.bias_rate * error, joint.max_correction_rate);
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

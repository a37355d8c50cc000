#pragma once
// What one joint does to its two bodies. Called for by a scene's list of joints.
//
// Solving looks at where the anchors will be when the substep has moved them, curvature included; relaxing,
// after the move, leaves them no speed against each other. For a joint by itself this is RATTLE (Andersen
// 1983) with the kick in front: the period is right to second order in h, and energy does not drift. Where
// bodies have n > 1 joints, these are swept (Gauss, Seidel) and yield: 0.4/n of an error is pulled in per
// substep, and a tenth of the impulse that was carried over is let go of. A load F at rest makes such a joint
// give way by F h^2 n / (4 m), m being the mass that it feels, and some four times that when it swings; asked
// for faster, what the sweeps have
// not passed on yet would be asked for twice, and swing up. Errors go at no more than 50 radii of the smaller
// body a second. Impulses act in pairs along one line or at one place: momenta are kept to rounding.
//
// A spring is solved once a substep, by an impulse that depends on stretch and speed just so that a pair by
// itself swings as the closed form does, whatever h: x'' = -w^2 x - 2 z w x', sampled every h, has the roots
// p = exp(h w (-z +- sqrt(z^2 - 1))), and so has the substep v' = v - scale v - pull x, x' = x + h v' with
// scale = 1 - p1 p2 and pull = (1 - p1) (1 - p2) / h. (v is without what the spring gives, so yield = 1 -
// scale.) Stretch acts explicitly. For nets of springs to be stable, h w counts as no more than 1 / sqrt(n):
// then none of a net's frequencies is above sqrt(2) / h (Gershgorin), and 2 / h is the limit.

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/solver/friction.h"
#include "sim_cuda/solver/joint_measure.h"

namespace collidoscope {

template <class Real, bool turning>
struct JointWork {
  const JointRow<Real>& joint;
  JointImpulse<Real>& given;
  JointEnds<Real, turning>& ends;
  Real h;  ///< s, of a substep

  SIM_HD JointWork(const JointRow<Real>& row, JointImpulse<Real>& impulse, JointEnds<Real, turning>& both,
                   Real substep)
      : joint(row), given(impulse), ends(both), h(substep) {}

  SIM_HD void warm_start() {
    if (whirls(ends.a) || whirls(ends.b)) {
      given = {Vector3<Real>::Zero(), 0, 0, {0, 0}};
      return;
    }
    const Real keep = joint.stiffness.keep;
    given.linear *= keep;
    given.lower *= keep;
    given.upper *= keep;
    if (joint.kind == JointKind::ball || joint.kind == JointKind::hinge) {
      push_point(given.linear);
      if constexpr (turning)
        if (joint.kind == JointKind::hinge) {
          const Hinge hinge(*this);
          given.across[0] *= keep;
          given.across[1] *= keep;
          turn(given.across[0] * hinge.side + given.across[1] * hinge.other +
               (given.lower - given.upper) * hinge.axis);
        }
    } else {
      const Real length = length_of(ends.apart);
      push_along(direction(length), given.linear.x() + given.lower - given.upper);
    }
  }

  template <JointPhase phase>
  SIM_HD void sweep() {
    if (joint.kind == JointKind::distance || joint.kind == JointKind::spring) return line<phase>();
    if constexpr (turning)
      if (joint.kind == JointKind::hinge) hinge<phase>();
    point<phase>();
  }

 private:
  /// It turns so far in a substep, by half a radian, that an impulse of the substep before is none for this
  /// one: carried over all the same, joints that contradict each other would bring energy without end.
  SIM_HD bool whirls(const JointEnd<Real, turning>& end) const {
    if constexpr (turning) return h * h * end.rate.dot(end.rate) > Real(0.25);
    return false;
  }
  static SIM_HD Real length_of(const Vector3<Real>& v) {
    using std::sqrt;
    return sqrt(v.dot(v));
  }
  /// From a's anchor to b's; up, where they are in one place.
  SIM_HD Vector3<Real> direction(Real length) const {
    return length > 0 ? Vector3<Real>(ends.apart / length) : Vector3<Real>(0, 0, 1);
  }
  static SIM_HD Real inverse(Real ease) { return ease > 0 ? 1 / ease : Real(0); }
  SIM_HD void push_along(const Vector3<Real>& normal, Real impulse) {
    const Vector3<Real> vector = impulse * normal;
    ends.b.push(vector, ends.b.arm);
    ends.a.push(-vector, ends.a.arm);
  }
  SIM_HD void turn(const Vector3<Real>& impulse) {
    ends.b.turn(impulse);
    ends.a.turn(-impulse);
  }

  SIM_HD Real bounded(Real speed) const { return clamp_to(speed, -joint.fastest, joint.fastest); }
  /// What is held from both sides: the new part of `impulse`.
  template <JointPhase phase>
  SIM_HD Real hold(Real error, Real speed, Real mass, Real impulse) const {
    const JointStiffness<Real>& s = joint.stiffness;
    if (phase == JointPhase::relax) return -mass * speed;
    const Real pull = joint.kind == JointKind::spring ? s.pull * error : bounded(s.pull * error);
    return -mass * (s.scale * speed + pull) - s.yield * impulse;
  }
  /// What is held from one side, by a gap that `speed` opens; < 0: too far. May close, and not more.
  template <JointPhase phase>
  SIM_HD Real limit(Real gap, Real speed, Real mass, Real& impulse) const {
    if (phase == JointPhase::relax && gap > 0 && !(impulse > 0)) return 0;
    const Real change = gap > 0 ? -mass * (speed + gap / h) : hold<phase>(gap, speed, mass, impulse);
    const Real next = max_of(impulse + change, Real(0)), given_now = next - impulse;
    impulse = next;
    return given_now;
  }

  // ---- along the line from anchor to anchor ----

  template <JointPhase phase>
  SIM_HD void line() {
    const bool spring = joint.kind == JointKind::spring;
    if (phase == JointPhase::relax && spring) return;
    const Real length = length_of(ends.apart);
    const Vector3<Real> normal = direction(length);
    const Real ease = ends.a.ease_along(normal, ends.a.arm) + ends.b.ease_along(normal, ends.b.arm);
    const Real mass = inverse(ease);
    Real speed = (ends.b.speed_at(ends.b.arm) - ends.a.speed_at(ends.a.arm)).dot(normal);
    if constexpr (phase == JointPhase::solve) {
      const Vector3<Real> mean = ends.b.mean_speed_at(ends.b.arm, h) - ends.a.mean_speed_at(ends.a.arm, h);
      const Vector3<Real> then = ends.apart + h * mean;
      if (ends.apart.dot(then) > 0)  // else it passes through 0, which is no curve
        speed += bounded(mean.dot(ends.apart + then) / (length + length_of(then)) - speed);
    }
    Real change = 0;
    if (joint.low == joint.high) {
      change = hold<phase>(length - joint.low, speed, mass, given.linear.x());
      given.linear.x() += change;
    } else {
      if (joint.low > 0) change += limit<phase>(length - joint.low, speed, mass, given.lower);
      if (finite(joint.high))
        change -= limit<phase>(joint.high - length, -(speed + change * ease), mass, given.upper);
    }
    push_along(normal, change);
  }

  // ---- one point in common ----

  // Impulses act midway between the anchors, on both bodies at one place, so that they keep the angular
  // momentum.
  SIM_HD Vector3<Real> arm_a() const {
    return joint.b == JointRow<Real>::world ? ends.a.arm : Vector3<Real>(ends.a.arm + ends.apart / 2);
  }
  SIM_HD Vector3<Real> arm_b() const { return ends.b.arm - ends.apart / 2; }
  SIM_HD void push_point(const Vector3<Real>& impulse) {
    ends.b.push(impulse, arm_b());
    ends.a.push(-impulse, arm_a());
  }

  template <JointPhase phase>
  SIM_HD void point() {
    Symmetric3<Real> ease;
    ends.a.add_ease(arm_a(), ease);
    ends.b.add_ease(arm_b(), ease);
    Vector3<Real> wanted = ends.b.speed_at(arm_b()) - ends.a.speed_at(arm_a());
    if constexpr (phase == JointPhase::solve) {
      const Vector3<Real> mean = ends.b.mean_speed_at(ends.b.arm, h) - ends.a.mean_speed_at(ends.a.arm, h);
      wanted += within<Real>(mean - wanted + joint.stiffness.pull * ends.apart, joint.fastest);
    }
    const Vector3<Real> change = -ease.solve(wanted);
    given.linear += change;
    push_point(change);
  }

  // ---- one axis in common ----

  struct Hinge {
    Vector3<Real> axis, axis_b, side, other;  ///< world; axis, side and other are a's, right-handed
    SIM_HD explicit Hinge(const JointWork& work)
        : axis(work.ends.a.axes * work.joint.axis_a),
          axis_b(work.ends.b.axes * work.joint.axis_b),
          side(work.ends.a.axes * work.joint.side),
          other(axis.cross(side)) {}
  };

  template <JointPhase phase>
  SIM_HD void hinge() {
    const Hinge frame(*this);
    if (joint.limited) {
      const Real mass = inverse(frame.axis.dot(ends.a.eased(frame.axis) + ends.b.eased(frame.axis)));
      const HingeRoom<Real> room(joint, ends.a.axes, ends.b.axes);
      const auto rate = [&] { return (ends.b.rate - ends.a.rate).dot(frame.axis); };
      turn(limit<phase>(room.above, rate(), mass, given.lower) * frame.axis);
      turn(-limit<phase>(room.below, -rate(), mass, given.upper) * frame.axis);
    }
    const Vector3<Real> ease_side = ends.a.eased(frame.side) + ends.b.eased(frame.side);
    const Vector3<Real> ease_other = ends.a.eased(frame.other) + ends.b.eased(frame.other);
    const Real k00 = frame.side.dot(ease_side), k01 = frame.side.dot(ease_other),
               k11 = frame.other.dot(ease_other);
    const Vector3<Real> error = frame.axis.cross(frame.axis_b);
    Vector3<Real> wanted = ends.b.rate - ends.a.rate;
    if constexpr (phase == JointPhase::solve) {
      const Vector3<Real> a = ends.a.mean_turn(frame.axis, h), b = ends.b.mean_turn(frame.axis_b, h);
      const Vector3<Real> mean = a.cross(frame.axis_b) + frame.axis.cross(b) + h * a.cross(b);
      const Vector3<Real> across = wanted - wanted.dot(frame.axis) * frame.axis;
      wanted += within<Real>(mean - across + joint.stiffness.pull * error, joint.fastest_turn);
    }
    const Real determinant = k00 * k11 - k01 * k01, scale = inverse(determinant);
    const Real along_side = wanted.dot(frame.side), along_other = wanted.dot(frame.other);
    const Real change_side = -scale * (k11 * along_side - k01 * along_other);
    const Real change_other = -scale * (k00 * along_other - k01 * along_side);
    given.across[0] += change_side;
    given.across[1] += change_other;
    turn(change_side * frame.side + change_other * frame.other);
  }
};

}  // namespace collidoscope

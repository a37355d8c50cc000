#pragma once
// The two ends of a joint during a solve: body state, anchor, and response to impulses. Static bodies and
// the world do not respond. Without the effect rotation (`with_rotation` false), anchors are the body
// centres. Short-lived; loaded and stored per visit.
//
// `with_rotation` and the phase are template parameters of the stages. As run-time branches, each costs 2 %
// of a step of the scene `bridge` on an H200.

#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/solver/joint_state.h"
#include "sim_cuda/solver/small_matrix.h"

namespace collidoscope {

template <class Real, bool with_rotation>
struct JointEnd {
  Vector3<Real> center, velocity;  ///< m, m/s
  Real inverse_mass;               ///< 1/kg
  Vector3<Real> arm;               ///< m, from the centre to the anchor
  // Used only with rotation:
  Vector3<Real> angular_velocity;  ///< rad/s
  Vector3<Real> inverse_inertia;   ///< 1/(kg m^2), principal
  Quaternion<Real> axes;           ///< principal axes to world

  SIM_HD static JointEnd of(const BodyView<Real>& bodies, std::uint32_t body, const Vector3<Real>& anchor) {
    JointEnd end;
    end.center = bodies.position[body];
    end.velocity = bodies.velocity[body];
    end.inverse_mass = bodies.inverse_mass[body];
    end.arm = anchor;
    if constexpr (with_rotation) {
      end.angular_velocity = bodies.angular_velocity[body];
      end.axes = bodies.orientation[body];
      const Vector3<Real> inertia = bodies.inertia[body];
      end.inverse_inertia = end.inverse_mass > 0
                                ? Vector3<Real>(1 / inertia.x(), 1 / inertia.y(), 1 / inertia.z())
                                : Vector3<Real>(Vector3<Real>::Zero());
      end.arm = end.axes * anchor;
    }
    return end;
  }
  SIM_HD static JointEnd of_world(const Vector3<Real>& place) {
    JointEnd end;
    end.center = place;
    end.velocity = end.arm = end.angular_velocity = end.inverse_inertia = Vector3<Real>::Zero();
    end.inverse_mass = 0;
    end.axes = Quaternion<Real>(1, 0, 0, 0);
    return end;
  }
  SIM_HD void store(const BodyView<Real>& bodies, std::uint32_t body) const {
    if (!(inverse_mass > 0)) return;
    bodies.velocity[body] = velocity;
    if constexpr (with_rotation) bodies.angular_velocity[body] = angular_velocity;
  }

  /// Velocity of a point of the body, m/s; `from`: offset from the centre, m.
  SIM_HD Vector3<Real> velocity_at(const Vector3<Real>& from) const {
    if constexpr (with_rotation)
      return velocity + angular_velocity.cross(from);
    else
      return velocity;
  }
  /// Mean velocity of the point over the next move of h seconds, m/s. The move rotates by a Cayley map of h
  /// * angular velocity.
  SIM_HD Vector3<Real> mean_velocity_at(const Vector3<Real>& from, Real h) const {
    if constexpr (with_rotation)
      return velocity + mean_rotation_velocity(from, h);
    else
      return velocity;
  }
  SIM_HD Vector3<Real> mean_rotation_velocity(const Vector3<Real>& vector, Real h) const {
    const Vector3<Real> half = (h / 2) * angular_velocity, change = angular_velocity.cross(vector);
    return (change + half.cross(change)) / (1 + half.dot(half));
  }
  /// Change of the angular velocity by an angular impulse `moment` (N m s), rad/s.
  SIM_HD Vector3<Real> apply_inverse_inertia(const Vector3<Real>& moment) const {
    const bool isotropic =
        inverse_inertia.x() == inverse_inertia.y() && inverse_inertia.y() == inverse_inertia.z();
    if (isotropic) return inverse_inertia.x() * moment;
    const Vector3<Real> own = axes.conjugate() * moment;
    return axes * Vector3<Real>(inverse_inertia.x() * own.x(), inverse_inertia.y() * own.y(),
                                inverse_inertia.z() * own.z());
  }
  /// Inverse effective mass against an impulse along a unit vector at `from` (m from the centre), 1/kg.
  SIM_HD Real inverse_effective_mass(const Vector3<Real>& direction, const Vector3<Real>& from) const {
    if constexpr (with_rotation) {
      const Vector3<Real> moment = from.cross(direction);
      return inverse_mass + moment.dot(apply_inverse_inertia(moment));
    } else {
      return inverse_mass;
    }
  }
  /// Adds the inverse mass matrix against an impulse at `from`, 1/kg.
  SIM_HD void add_inverse_mass_matrix(const Vector3<Real>& from, Symmetric3<Real>& matrix) const {
    matrix.xx += inverse_mass;
    matrix.yy += inverse_mass;
    matrix.zz += inverse_mass;
    if constexpr (with_rotation) {
      const Vector3<Real> x = apply_inverse_inertia(Vector3<Real>(0, from.z(), -from.y())).cross(from);
      const Vector3<Real> y = apply_inverse_inertia(Vector3<Real>(-from.z(), 0, from.x())).cross(from);
      const Vector3<Real> z = apply_inverse_inertia(Vector3<Real>(from.y(), -from.x(), 0)).cross(from);
      matrix.xx += x.x();
      matrix.yy += y.y();
      matrix.zz += z.z();
      matrix.xy += y.x();
      matrix.xz += z.x();
      matrix.yz += z.y();
    }
  }
  SIM_HD void apply_impulse(const Vector3<Real>& impulse, const Vector3<Real>& from) {
    velocity += inverse_mass * impulse;
    if constexpr (with_rotation) angular_velocity += apply_inverse_inertia(from.cross(impulse));
  }
  SIM_HD void apply_angular_impulse(const Vector3<Real>& impulse) {
    angular_velocity += apply_inverse_inertia(impulse);
  }
};

template <class Real, bool with_rotation>
struct JointEnds {
  JointEnd<Real, with_rotation> a, b;
  Vector3<Real> separation;  ///< from a's anchor to b's, m

  SIM_HD JointEnds(const BodyView<Real>& bodies, const JointRow<Real>& joint)
      : a(JointEnd<Real, with_rotation>::of(bodies, joint.a, joint.anchor_a)),
        b(joint.b == JointRow<Real>::world
              ? JointEnd<Real, with_rotation>::of_world(joint.anchor_b)
              : JointEnd<Real, with_rotation>::of(bodies, joint.b, joint.anchor_b)),
        separation((b.center - a.center) + (b.arm - a.arm)) {}
  SIM_HD void store(const BodyView<Real>& bodies, const JointRow<Real>& joint) const {
    a.store(bodies, joint.a);
    if (joint.b != JointRow<Real>::world) b.store(bodies, joint.b);
  }
};

}  // namespace collidoscope

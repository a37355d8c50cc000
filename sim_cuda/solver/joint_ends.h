#pragma once
// The two ends of a joint while it is solved: the bodies, the anchors, and the effect of an impulse there.
// Static bodies and the world take none. `turning`: with the effect rotation; without it, bodies are held at
// their centres.
//
// `turning` and the phase are template parameters of the sweeps: as run-time branches they cost 2 % each
// of a step of the scene `bridge` on an H200.

#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/solver/joint_state.h"
#include "sim_cuda/solver/small_matrix.h"

namespace collidoscope {

template <class Real, bool turning>
struct JointEnd {
  Vector3<Real> center, velocity;  ///< m, m/s
  Real inverse_mass;               ///< 1/kg
  Vector3<Real> arm;               ///< m, from the centre to the anchor
  // Read only where bodies turn:
  Vector3<Real> rate;             ///< rad/s
  Vector3<Real> inverse_inertia;  ///< 1/(kg m^2), principal
  Quaternion<Real> axes;          ///< principal axes to world

  SIM_HD static JointEnd of(const BodyView<Real>& bodies, std::uint32_t body, const Vector3<Real>& anchor) {
    JointEnd end;
    end.center = bodies.position[body];
    end.velocity = bodies.velocity[body];
    end.inverse_mass = bodies.inverse_mass[body];
    end.arm = anchor;
    if constexpr (turning) {
      end.rate = bodies.angular_velocity[body];
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
    end.velocity = end.arm = end.rate = end.inverse_inertia = Vector3<Real>::Zero();
    end.inverse_mass = 0;
    end.axes = Quaternion<Real>(1, 0, 0, 0);
    return end;
  }
  SIM_HD void store(const BodyView<Real>& bodies, std::uint32_t body) const {
    if (!(inverse_mass > 0)) return;
    bodies.velocity[body] = velocity;
    if constexpr (turning) bodies.angular_velocity[body] = rate;
  }

  /// m/s, of a point of the body, `from` its centre.
  SIM_HD Vector3<Real> speed_at(const Vector3<Real>& from) const {
    if constexpr (turning)
      return velocity + rate.cross(from);
    else
      return velocity;
  }
  /// The same, as a mean over the next move of h seconds, which turns bodies by a Cayley map of h rate.
  SIM_HD Vector3<Real> mean_speed_at(const Vector3<Real>& from, Real h) const {
    if constexpr (turning)
      return velocity + mean_turn(from, h);
    else
      return velocity;
  }
  SIM_HD Vector3<Real> mean_turn(const Vector3<Real>& vector, Real h) const {
    const Vector3<Real> half = (h / 2) * rate, along = rate.cross(vector);
    return (along + half.cross(along)) / (1 + half.dot(half));
  }
  /// rad/s, that an angular impulse of so many N m s adds.
  SIM_HD Vector3<Real> eased(const Vector3<Real>& moment) const {
    const bool ball =
        inverse_inertia.x() == inverse_inertia.y() && inverse_inertia.y() == inverse_inertia.z();
    if (ball) return inverse_inertia.x() * moment;
    const Vector3<Real> own = axes.conjugate() * moment;
    return axes * Vector3<Real>(inverse_inertia.x() * own.x(), inverse_inertia.y() * own.y(),
                                inverse_inertia.z() * own.z());
  }
  /// 1/kg, against an impulse along a unit vector, `from` the centre.
  SIM_HD Real ease_along(const Vector3<Real>& direction, const Vector3<Real>& from) const {
    if constexpr (turning) {
      const Vector3<Real> moment = from.cross(direction);
      return inverse_mass + moment.dot(eased(moment));
    } else {
      return inverse_mass;
    }
  }
  /// 1/kg, against any impulse there.
  SIM_HD void add_ease(const Vector3<Real>& from, Symmetric3<Real>& ease) const {
    ease.xx += inverse_mass;
    ease.yy += inverse_mass;
    ease.zz += inverse_mass;
    if constexpr (turning) {
      const Vector3<Real> x = eased(Vector3<Real>(0, from.z(), -from.y())).cross(from);
      const Vector3<Real> y = eased(Vector3<Real>(-from.z(), 0, from.x())).cross(from);
      const Vector3<Real> z = eased(Vector3<Real>(from.y(), -from.x(), 0)).cross(from);
      ease.xx += x.x();
      ease.yy += y.y();
      ease.zz += z.z();
      ease.xy += y.x();
      ease.xz += z.x();
      ease.yz += z.y();
    }
  }
  SIM_HD void push(const Vector3<Real>& impulse, const Vector3<Real>& from) {
    velocity += inverse_mass * impulse;
    if constexpr (turning) rate += eased(from.cross(impulse));
  }
  SIM_HD void turn(const Vector3<Real>& impulse) { rate += eased(impulse); }
};

template <class Real, bool turning>
struct JointEnds {
  JointEnd<Real, turning> a, b;
  Vector3<Real> apart;  ///< m, from a's anchor to b's

  SIM_HD JointEnds(const BodyView<Real>& bodies, const JointRow<Real>& joint)
      : a(JointEnd<Real, turning>::of(bodies, joint.a, joint.anchor_a)),
        b(joint.b == JointRow<Real>::world ? JointEnd<Real, turning>::of_world(joint.anchor_b)
                                           : JointEnd<Real, turning>::of(bodies, joint.b, joint.anchor_b)),
        apart((b.center - a.center) + (b.arm - a.arm)) {}
  SIM_HD void store(const BodyView<Real>& bodies, const JointRow<Real>& joint) const {
    a.store(bodies, joint.a);
    if (joint.b != JointRow<Real>::world) b.store(bodies, joint.b);
  }
};

}  // namespace collidoscope

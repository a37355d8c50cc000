#pragma once
// Coulomb's friction: a contact resists sliding with at most mu times its normal impulse. Called for by a
// material whose coefficient is not 0; turns bodies, so it comes with rotation. A pair takes the geometric
// mean of its two coefficients (as in Box2D and box3d): ice is slippery under any sole.
//
// Clamped as a vector: clamping two axes each by itself would let a body creep across the diagonal.

#include <cstdint>

#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/dynamics/body_state.h"

namespace collidoscope {

template <class Real>
struct Friction {
  const Real* of_material = nullptr;        ///< 0 to 100, by material
  const std::uint16_t* material = nullptr;  ///< by body; null where all bodies are of material 0

  SIM_HD Real of_body(std::uint32_t body) const {
    return of_material[material == nullptr ? 0 : material[body]];
  }
  SIM_HD static Real between(Real mu_a, Real mu_b) {
    using std::sqrt;
    return sqrt(mu_a * mu_b);
  }
};

/// `impulse`, no longer than `limit` >= 0.
template <class Real>
SIM_HD Vector3<Real> clamp_length(const Vector3<Real>& impulse, Real limit) {
  const Real squared = impulse.dot(impulse);
  if (!(squared > limit * limit)) return impulse;
  using std::sqrt;
  return (limit / sqrt(squared)) * impulse;
}

/// Works against a slip of `slip` m/s with `mass` kg; `accumulated` in N s is what was given so far, and at
/// most `limit` long afterwards. Returns what is new.
template <class Real>
SIM_HD Vector3<Real> solve_friction(const Vector3<Real>& slip, Real mass, Real limit,
                                    Vector3<Real>& accumulated) {
  const Vector3<Real> next = clamp_length<Real>(accumulated - mass * slip, limit);
  const Vector3<Real> change = next - accumulated;
  accumulated = next;
  return change;
}

/// The part of a vector across a unit normal.
template <class Real>
SIM_HD Vector3<Real> tangential_part(const Vector3<Real>& vector, const Vector3<Real>& normal) {
  return vector - vector.dot(normal) * normal;
}

/// How a body turns, and what an angular impulse makes of it.
template <class Real>
struct AngularState {
  Vector3<Real> velocity;  ///< rad/s
  Vector3<Real> inertia;   ///< kg m^2, principal
  Quaternion<Real> axes;   ///< principal axes to world; not read for a ball

  SIM_HD static AngularState of(const BodyView<Real>& bodies, std::uint32_t body) {
    return {bodies.angular_velocity[body], bodies.inertia[body], bodies.orientation[body]};
  }
  SIM_HD bool is_isotropic() const { return inertia.x() == inertia.y() && inertia.y() == inertia.z(); }
  /// 1/(kg m^2), about the axis that turns most easily: what a slip is divided by must not be less.
  SIM_HD Real inverse_inertia_max() const {
    const Real least = inertia.x() < inertia.y() ? inertia.x() : inertia.y();
    return 1 / (least < inertia.z() ? least : inertia.z());
  }
  /// `impulse` in N m s, world axes.
  SIM_HD void apply_angular_impulse(const Vector3<Real>& impulse) {
    if (is_isotropic()) {
      velocity += impulse / inertia.x();
      return;
    }
    const Vector3<Real> body = axes.conjugate() * impulse;
    velocity += axes * Vector3<Real>(body.x() / inertia.x(), body.y() / inertia.y(), body.z() / inertia.z());
  }
};

}  // namespace collidoscope

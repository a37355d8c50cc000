#pragma once
// Sums over all bodies at one state: energy, momenta, extremes. In double, in the fixed order of
// core/reduce.h.

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/narrow_phase/contact_list.h"
#include "sim_cuda/narrow_phase/sphere_sphere.h"
#include "sim_cuda/solver/walls.h"

namespace collidoscope {

struct BodySums {
  double kinetic, potential;            ///< J
  Vector3d momentum, angular_momentum;  ///< kg m/s; kg m^2/s about the origin
  double wall_impulse;                  ///< N s
  Vector3d wall_vector;                 ///< N s
  double push_work;                     ///< J
  double max_speed_squared;             ///< m^2/s^2
  double max_depth;                     ///< m, into walls
  std::int64_t non_finite, escaped;
};

SIM_HD inline BodySums combine(const BodySums& a, const BodySums& b) {
  BodySums s;
  s.kinetic = a.kinetic + b.kinetic;
  s.potential = a.potential + b.potential;
  s.momentum = a.momentum + b.momentum;
  s.angular_momentum = a.angular_momentum + b.angular_momentum;
  s.wall_impulse = a.wall_impulse + b.wall_impulse;
  s.wall_vector = a.wall_vector + b.wall_vector;
  s.push_work = a.push_work + b.push_work;
  s.max_speed_squared = max_of(a.max_speed_squared, b.max_speed_squared);
  s.max_depth = max_of(a.max_depth, b.max_depth);
  s.non_finite = a.non_finite + b.non_finite;
  s.escaped = a.escaped + b.escaped;
  return s;
}

template <class Real>
struct MeasureBody {
  BodyView<Real> bodies;
  const WallLedger* ledger;  ///< null where there are no walls
  const WallPlane<Real>* planes;
  int plane_count;
  Vector3d gravity;  ///< m/s^2
  double ground;     ///< m, z at which potential energy is zero
  bool boxed;
  Vector3d low, high;  ///< m, the box

  SIM_HD BodySums operator()(std::int64_t body) const {
    const Vector3d x = bodies.position[body].template cast<double>(),
                   v = bodies.velocity[body].template cast<double>();
    const double m = static_cast<double>(bodies.mass[body]), r = static_cast<double>(bodies.radius[body]);
    BodySums s;
    bool whole = true;
    for (int k = 0; k < 3; ++k) whole = whole && finite(x[k]) && finite(v[k]);
    s.kinetic = m * v.dot(v) / 2;
    s.potential = -m * gravity.dot(x - Vector3d(0, 0, ground));
    s.momentum = m * v;
    s.angular_momentum = x.cross(s.momentum);
    if (bodies.orientation != nullptr) {
      const Quaterniond q = bodies.orientation[body].template cast<double>();
      const Vector3d w = bodies.angular_velocity[body].template cast<double>();
      const Vector3d inertia = bodies.inertia[body].template cast<double>();
      const Vector3d w_body = q.conjugate() * w;
      const Vector3d l_body(inertia.x() * w_body.x(), inertia.y() * w_body.y(), inertia.z() * w_body.z());
      s.kinetic += w_body.dot(l_body) / 2;
      s.angular_momentum += q * l_body;
      for (int k = 0; k < 3; ++k) whole = whole && finite(w[k]) && finite(q.coeffs()[k]);
      whole = whole && finite(q.w());
    }
    s.wall_impulse = s.push_work = 0;
    s.wall_vector = Vector3d(0, 0, 0);
    if (ledger != nullptr) {
      s.wall_impulse = ledger[body].impulse;
      s.wall_vector = Vector3d(ledger[body].vector[0], ledger[body].vector[1], ledger[body].vector[2]);
      s.push_work = ledger[body].push_work;
    }
    s.max_speed_squared = v.dot(v);
    s.max_depth = 0;
    for (int p = 0; p < plane_count; ++p) {
      const double gap =
          planes[p].normal.template cast<double>().dot(x) - static_cast<double>(planes[p].offset) - r;
      s.max_depth = max_of(s.max_depth, -gap);
    }
    s.non_finite = whole ? 0 : 1;
    s.escaped = 0;
    if (boxed) {
      bool inside = true;
      for (int k = 0; k < 3; ++k) inside = inside && x[k] >= low[k] && x[k] <= high[k];
      s.escaped = inside ? 0 : 1;
    }
    return s;
  }
};

struct Depth {
  double value;  ///< m
};
SIM_HD inline Depth combine(Depth a, Depth b) { return {max_of(a.value, b.value)}; }

/// How deep the two bodies of a contact overlap at the current poses.
template <class Real>
struct MeasureDepth {
  const Pair* contacts;
  const StepControl* control;
  SphereView<Real> spheres;
  SIM_HD Depth operator()(std::int64_t contact) const {
    if (contact >= static_cast<std::int64_t>(control->contacts)) return {0};
    const auto [a, b] = contacts[contact];
    const Real gap =
        separate<Real>(spheres.position[a], spheres.radius[a], spheres.position[b], spheres.radius[b]).gap;
    return {max_of(0.0, -static_cast<double>(gap))};
  }
};

}  // namespace collidoscope

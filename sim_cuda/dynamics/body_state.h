#pragma once
// State of all bodies: one array per quantity, indexed by body id, in the executor's memory. Arrays that no
// active effect needs are empty, and their pointers null.
//
// The paper stores momenta (Baraff 1997). This code stores velocities, which contacts need. Momenta are
// computed where they are reported (measure/measure.h, measure/inspect.h).

#include <cstdint>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/core/packed_vector.h"

namespace collidoscope {

/// Pointers to the state, for stages.
template <class Real>
struct BodyView {
  Vector3<Real>* position;                ///< m, centre of mass
  PackedVector3<Real>* velocity;          ///< m/s
  Quaternion<Real>* orientation;          ///< principal axes to world; null without rotation
  PackedVector3<Real>* angular_velocity;  ///< rad/s, world axes; null without rotation
  const Real* radius;                     ///< m
  const Real* mass;                       ///< kg; 0 for kinematic and static bodies
  const Real* inverse_mass;               ///< 1/kg; 0 for kinematic and static bodies
  const Vector3<Real>* inertia;  ///< kg m^2, principal moments; null without rotation; infinite for kinematic
                                 ///< and static bodies
};

/// Accumulated effect of walls, obstacles and overlap recovery on a body since the start. Always double,
/// because it is a long sum.
struct StaticImpulse {
  double impulse = 0;     ///< N s, sum of magnitudes
  double vector[3] = {};  ///< N s, applied to the body
  double push_work = 0;   ///< J, potential energy added by overlap recovery
};

template <class Real>
struct BodyBuffers {
  explicit BodyBuffers(Executor& executor)
      : position(executor, "positions"),
        velocity(executor, "velocities"),
        orientation(executor, "orientations"),
        angular_velocity(executor, "angular velocities"),
        angular_velocity_low(executor, "low parts of angular velocities"),
        radius(executor, "radii"),
        mass(executor, "masses"),
        inverse_mass(executor, "inverse masses"),
        inertia(executor, "inertia"),
        material(executor, "body materials"),
        static_impulses(executor, "wall impulse sums") {}
  BodyView<Real> view() const {
    return {position.data(), velocity.data(), orientation.data(),  angular_velocity.data(),
            radius.data(),   mass.data(),     inverse_mass.data(), inertia.data()};
  }
  Buffer<Vector3<Real>> position;
  Buffer<PackedVector3<Real>> velocity;
  Buffer<Quaternion<Real>> orientation;
  Buffer<PackedVector3<Real>> angular_velocity;
  Buffer<Vector3<float>> angular_velocity_low;  ///< rad/s (wide_spin.h); only in float, with unequal moments
  Buffer<Real> radius, mass, inverse_mass;
  Buffer<Vector3<Real>> inertia;
  Buffer<std::uint16_t> material;         ///< empty if all bodies have material 0
  Buffer<StaticImpulse> static_impulses;  ///< empty without walls
};

}  // namespace collidoscope

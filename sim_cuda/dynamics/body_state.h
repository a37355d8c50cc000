#pragma once
// The state of all bodies, one array per quantity, by id, in the executor's memory. Arrays that no effect
// calls for are empty and their pointers null.
//
// The paper stores momenta (Baraff 1997). Here velocities are stored, as contacts need them; momenta are
// derived from them where they are reported (measure/measure.h, inspect.h).

#include <cstdint>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/core/packed_vector.h"

namespace collidoscope {

/// What stages read and write.
template <class Real>
struct BodyView {
  Vector3<Real>* position;                ///< m, centre of mass
  PackedVector3<Real>* velocity;          ///< m/s
  Quaternion<Real>* orientation;          ///< principal axes to world; null where nothing turns
  PackedVector3<Real>* angular_velocity;  ///< rad/s, world axes; null where nothing turns
  const Real* radius;                     ///< m
  const Real* mass;                       ///< kg; 0 of a body that no force moves
  const Real* inverse_mass;               ///< 1/kg, the same
  const Vector3<Real>* inertia;  ///< kg m^2, principal; null where nothing turns; infinite of such a body
};

/// What walls and obstacles did to a body since the start. In double, whatever the precision of the run: it
/// is a long sum.
struct StaticImpulse {
  double impulse = 0;     ///< N s, sum of magnitudes
  double vector[3] = {};  ///< N s, given to the body
  double push_work = 0;   ///< J, potential energy that pushing it out of walls added
};

template <class Real>
struct BodyBuffers {
  explicit BodyBuffers(Executor& executor)
      : position(executor, "positions"),
        velocity(executor, "velocities"),
        orientation(executor, "orientations"),
        angular_velocity(executor, "angular velocities"),
        radius(executor, "radii"),
        mass(executor, "masses"),
        inverse_mass(executor, "inverse masses"),
        inertia(executor, "inertia"),
        material(executor, "materials of bodies"),
        static_impulses(executor, "wall ledgers") {}
  BodyView<Real> view() const {
    return {position.data(), velocity.data(), orientation.data(),  angular_velocity.data(),
            radius.data(),   mass.data(),     inverse_mass.data(), inertia.data()};
  }
  Buffer<Vector3<Real>> position;
  Buffer<PackedVector3<Real>> velocity;
  Buffer<Quaternion<Real>> orientation;
  Buffer<PackedVector3<Real>> angular_velocity;
  Buffer<Real> radius, mass, inverse_mass;
  Buffer<Vector3<Real>> inertia;
  Buffer<std::uint16_t> material;         ///< empty where all are of material 0
  Buffer<StaticImpulse> static_impulses;  ///< empty where there are no walls
};

}  // namespace collidoscope

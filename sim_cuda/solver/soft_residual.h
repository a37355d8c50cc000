#pragma once
// Residual (residual.h) of one contact of `soft_step`, or of the planes of one body. Computes the change of
// the next iteration with the same equations, without changing any state. A functor.

#include <cstdint>

#include "sim_cuda/solver/residuals.h"
#include "sim_cuda/solver/soft_iteration.h"
#include "sim_cuda/solver/soft_walls.h"

namespace collidoscope {

/// Items: all bodies (for their planes), then contacts by place.
template <class Real, bool with_friction, bool with_box_obstacles>
struct SoftResidual {
  SoftWalls<Real, with_friction, with_box_obstacles> walls;
  OrderedContacts<Real, with_friction> contacts;
  Softness<Real> softness;
  bool soft;                   ///< true: solve with softness; false: relax, with friction
  const std::uint8_t* asleep;  ///< by body; null without the effect sleeping
  const StepControl* control;

  SIM_HD ResidualSum operator()(std::int64_t item) const {
    ResidualSum sum;
    if (item < walls.body_count)
      add_planes(static_cast<int>(item), sum);
    else if (item - walls.body_count < static_cast<std::int64_t>(control->contacts))
      add_contact(static_cast<std::uint32_t>(item - walls.body_count), sum);
    return sum;
  }

  SIM_HD bool sleeps(std::uint32_t body) const { return asleep != nullptr && asleep[body] != 0; }

  SIM_HD void add_contact(std::uint32_t place, ResidualSum& sum) const {
    auto loaded = contacts.load(place);
    const Pair ids = loaded.ids;
    if (sleeps(ids.a) || sleeps(ids.b)) return;
    SoftContact<Real>& k = loaded.contact;
    const bool acts = k.impulse > 0 || !(k.gap > 0);
    const Real w_a = loaded.bodies.inverse_mass_a, w_b = loaded.bodies.inverse_mass_b;
    const Vector3<Real> velocity = walls.bodies.velocity[ids.b].load() - walls.bodies.velocity[ids.a].load();
    const bool passes =
        soft && k.gap > 0 &&
        k.passes(velocity, loaded.bodies.radius_a + loaded.bodies.radius_b, 1 / walls.inverse_h);
    const Real change = passes ? -k.impulse
                        : soft ? k.template solve<true>(velocity.dot(k.normal), 1 / (w_a + w_b), softness)
                               : k.template solve<false>(velocity.dot(k.normal), 1 / (w_a + w_b), softness);
    const Real normal_residual = (w_a + w_b) * change;
    double squared = static_cast<double>(normal_residual) * static_cast<double>(normal_residual);
    if constexpr (with_friction) {
      Vector3<Real> accumulated_friction = loaded.friction.impulse;
      if (!soft && (k.impulse > 0 || accumulated_friction.dot(accumulated_friction) > 0)) {
        const FrictionConstraint<Real> pair(walls.bodies.angular_velocity[ids.a],
                                            walls.bodies.angular_velocity[ids.b], k, loaded.bodies,
                                            loaded.inertia);
        const Real inverse_mass = w_a + w_b + pair.angular_inverse_mass_a() + pair.angular_inverse_mass_b();
        const Vector3<Real> friction_residual =
            inverse_mass * solve_friction<Real>(pair.slip(velocity), 1 / inverse_mass,
                                                loaded.friction.coefficient * k.impulse,
                                                accumulated_friction);
        squared += static_cast<double>(friction_residual.dot(friction_residual));
      }
    }
    if (acts || squared > 0) sum.add(squared);
  }

  SIM_HD void add_planes(int id, ResidualSum& sum) const {
    if (sleeps(static_cast<std::uint32_t>(id)) || !(walls.bodies.inverse_mass[id] > 0)) return;
    const typename SoftWalls<Real, with_friction, with_box_obstacles>::Body body = walls.load(id);
    for (int p = 0; p < walls.count(); ++p) {
      const WallPlane<Real> plane = walls.plane(p, id);
      if (!(plane.normal.dot(plane.normal) > 0)) continue;  // box without contact
      const std::int64_t entry = walls.index(p, id);
      const Real gap = max_of(plane.normal.dot(body.x) - plane.offset - body.radius, Real(0));
      const Real accumulated = walls.impulse[entry];
      if (!soft && gap > 0 && !(accumulated > 0)) continue;
      const Real next =
          max_of(accumulated - body.mass * (plane.normal.dot(body.v) + gap * walls.inverse_h), Real(0));
      const Real normal_residual = body.inverse_mass * (next - accumulated);
      double squared = static_cast<double>(normal_residual) * static_cast<double>(normal_residual);
      if constexpr (with_friction) {
        if (!soft) {
          Vector3<Real> accumulated_friction = walls.friction.impulse[entry];
          const Real inverse_mass =
              body.inverse_mass + body.radius * body.radius * body.angular.inverse_inertia_max();
          const Real mu = Friction<Real>::between(
              walls.friction.coefficients.of_body(static_cast<std::uint32_t>(id)), plane.friction);
          const Vector3<Real> slip = tangential_part<Real>(
              body.v - body.radius * body.angular.velocity.cross(plane.normal), plane.normal);
          const Vector3<Real> change =
              inverse_mass * solve_friction<Real>(slip, 1 / inverse_mass, mu * next, accumulated_friction);
          squared += static_cast<double>(change.dot(change));
        }
      }
      if (accumulated > 0 || !(gap > 0) || squared > 0) sum.add(squared);
    }
  }
};

}  // namespace collidoscope

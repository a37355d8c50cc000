#pragma once
// The residual (residual.h) of one contact of `soft_step`, and of the planes that one body touches: what the
// next sweep would give, by the very equations that it would use, and nothing is changed.

#include <cstdint>

#include "sim_cuda/solver/residuals.h"
#include "sim_cuda/solver/soft_sweeps.h"
#include "sim_cuda/solver/soft_walls.h"

namespace collidoscope {

/// Items: all bodies, for what each touches by itself, then contacts by place.
template <class Real, bool rubbed, bool boxed>
struct SoftResidual {
  SoftWalls<Real, rubbed, boxed> walls;
  SweptContacts<Real, rubbed> contacts;
  Softness<Real> softness;
  bool soft;  ///< of a sweep that solves; else of one that relaxes, with friction where there is any
  const std::uint8_t* asleep;  ///< by body; null where nothing sleeps
  bool held;                   ///< as Solve's
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
    auto known = contacts.load(place);
    const Pair ids = known.ids;
    if (sleeps(ids.a) || sleeps(ids.b)) return;
    SoftContact<Real>& k = known.contact;
    const bool acts = k.impulse > 0 || !(k.gap > 0);
    const Real w_a = known.bodies.inverse_mass_a, w_b = known.bodies.inverse_mass_b;
    const Vector3<Real> velocity = walls.bodies.velocity[ids.b].load() - walls.bodies.velocity[ids.a].load();
    const bool passes =
        soft && held && k.gap > 0 &&
        k.passes(velocity, known.bodies.radius_a + known.bodies.radius_b, 1 / walls.inverse_h);
    const Real change = passes ? -k.impulse
                        : soft ? k.template solve<true>(velocity.dot(k.normal), 1 / (w_a + w_b), softness)
                               : k.template solve<false>(velocity.dot(k.normal), 1 / (w_a + w_b), softness);
    const Real pressed = (w_a + w_b) * change;
    double squared = static_cast<double>(pressed) * static_cast<double>(pressed);
    if constexpr (rubbed) {
      Vector3<Real> given = known.grip.impulse;
      if (!soft && (k.impulse > 0 || given.dot(given) > 0)) {
        const RubbedPair<Real> pair(walls.bodies.angular_velocity[ids.a],
                                    walls.bodies.angular_velocity[ids.b], k, known.bodies, known.turned);
        const Real eases = w_a + w_b + pair.ease_a() + pair.ease_b();
        const Vector3<Real> rubbed_off =
            eases * rub<Real>(pair.slip(velocity), 1 / eases, known.grip.coefficient * k.impulse, given);
        squared += static_cast<double>(rubbed_off.dot(rubbed_off));
      }
    }
    if (acts || squared > 0) sum.add(squared);
  }

  SIM_HD void add_planes(int id, ResidualSum& sum) const {
    if (sleeps(static_cast<std::uint32_t>(id)) || !(walls.bodies.inverse_mass[id] > 0)) return;
    const typename SoftWalls<Real, rubbed, boxed>::Body body = walls.load(id);
    for (int p = 0; p < walls.count(); ++p) {
      const WallPlane<Real> plane = walls.plane(p, id);
      if (!(plane.normal.dot(plane.normal) > 0)) continue;  // a box that it does not touch
      const std::int64_t at = walls.place(p, id);
      const Real gap = max_of(plane.normal.dot(body.x) - plane.offset - body.radius, Real(0));
      const Real known = walls.impulse[at];
      if (!soft && gap > 0 && !(known > 0)) continue;
      const Real next =
          max_of(known - body.mass * (plane.normal.dot(body.v) + gap * walls.inverse_h), Real(0));
      const Real pressed = body.inverse_mass * (next - known);
      double squared = static_cast<double>(pressed) * static_cast<double>(pressed);
      if constexpr (rubbed) {
        if (!soft) {
          Vector3<Real> given = walls.grips.impulse[at];
          const Real ease = body.inverse_mass + body.radius * body.radius * body.spin.ease();
          const Real mu = Friction<Real>::between(
              walls.grips.friction.of_body(static_cast<std::uint32_t>(id)), plane.friction);
          const Vector3<Real> slip =
              across<Real>(body.v - body.radius * body.spin.rate.cross(plane.normal), plane.normal);
          const Vector3<Real> change = ease * rub<Real>(slip, 1 / ease, mu * next, given);
          squared += static_cast<double>(change.dot(change));
        }
      }
      if (known > 0 || !(gap > 0) || squared > 0) sum.add(squared);
    }
  }
};

}  // namespace collidoscope

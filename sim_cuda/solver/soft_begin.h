#pragma once
// The first stage of a substep of `soft_step`. A functor.

#include <cstdint>
#include <type_traits>

#include "sim_cuda/core/block.h"
#include "sim_cuda/core/ordered_sums.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/core/vector_load.h"
#include "sim_cuda/solver/contact_storage.h"
#include "sim_cuda/solver/contacts_by_body.h"
#include "sim_cuda/solver/soft_walls.h"

namespace collidoscope {

/// Applies forces and warm starting, then solves the planes once.
template <class Real, bool with_friction, bool with_box_obstacles>
struct BeginSubstep {
  BodyView<Real> bodies;
  const PackedContact<Real>* soft;
  ContactsByBodyView by_body;
  SoftWalls<Real, with_friction, with_box_obstacles> walls;
  Vector3<Real> gravity;       ///< m/s^2
  const Vector3<Real>* field;  ///< acceleration by attractors, m/s^2, by body; null if the effect is off
  bool with_field;             ///< true if gravity or attractors are on
  Real h;                      ///< s
  PackedVector3<Real>*start_velocity, *start_spin;  ///< see EnergyGuard; start_spin may be null
  const StepControl* control;

  SIM_HD void operator()(int id) const {
    if (control->overflow) return;
    begin(id, ImpulseSums::accumulate(contacts_of(id), entry(id)));
  }

  SIM_HD bool is_large(int id) const { return !control->overflow && contacts_of(id) > large_list_size; }
#if defined(__CUDACC__)
  __device__ void process_by_block(int id) const {
    const ImpulseSums impulses = ImpulseSums::accumulate_by_block(contacts_of(id), entry(id));
    if (threadIdx.x == 0) begin(id, impulses);
  }
#endif

 private:
  /// Sums over a body's contacts: momentum, with friction included, and moment.
  using ImpulseSums = std::conditional_t<with_friction, OrderedSums<Real, 0, 0, 1>, OrderedSums<Real, 0>>;

  SIM_HD std::uint32_t contacts_of(int id) const { return control->contacts > 0 ? by_body.count[id] : 0; }
  SIM_HD auto entry(int id) const {
    return [this, id, radius = walls.bodies.radius[id]](std::uint32_t k, Vector3<Real>* vectors) {
      const ContactEnd end = by_body.end(id, k);
      const Real sign = end.sign<Real>();
      const auto& contact = load_readonly(&soft[end.contact]);
      vectors[0] = sign * contact.impulse * contact.normal;
      if constexpr (with_friction) {
        vectors[1] = sign * contact.friction_impulse;
        vectors[2] = -((radius + contact.gap / 2) * contact.normal.cross(contact.friction_impulse));
      }
    };
  }

  SIM_HD void begin(int id, const ImpulseSums& impulses) const {
    typename SoftWalls<Real, with_friction, with_box_obstacles>::Body body = walls.load(id);
    start_velocity[id] = body.v;
    if (start_spin != nullptr)
      start_spin[id] = AngularState<Real>::of(walls.bodies, static_cast<std::uint32_t>(id)).spin();
    const Vector3<Real> pull = field != nullptr ? Vector3<Real>(gravity + field[id]) : walls.gravity;
    if (with_field) body.v += h * pull;
    walls.clear_stopped(id);
    if constexpr (with_box_obstacles) walls.update_box_planes(id, body);
    walls.warm_start(id, body);
    if (contacts_of(id) > 0) {
      body.v += body.inverse_mass * impulses.sum[0];
      if constexpr (with_friction) body.angular.apply_angular_impulse(impulses.sum[1]);
    }
    if (!walls.is_clear(body)) walls.solve(id, body, WallPass::solve, pull);
    body.velocity_changed = true;
    walls.store(id, body);
  }
};

/// Stores EnergyGuard::start_rotation(). A stage of its own, because most scenes do not need it.
template <class Real>
struct StoreRotationEnergy {
  BodyView<Real> bodies;
  Real* start_rotation;
  SIM_HD void operator()(int id) const {
    const AngularState<Real> angular = AngularState<Real>::of(bodies, static_cast<std::uint32_t>(id));
    if (bodies.inverse_mass[id] > 0 && !angular.is_isotropic())
      start_rotation[id] = static_cast<Real>(angular.energy_of(angular.spin()));
  }
};

}  // namespace collidoscope

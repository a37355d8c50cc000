#pragma once
// The stage of `soft_step` that begins a substep. A functor.

#include <cstdint>
#include <type_traits>

#include "sim_cuda/core/block.h"
#include "sim_cuda/core/ordered_sums.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/core/whole_record.h"
#include "sim_cuda/solver/contacts_by_body.h"
#include "sim_cuda/solver/soft_memory.h"
#include "sim_cuda/solver/soft_walls.h"

namespace collidoscope {

/// Forces, the impulses of the substep before, and the first sweep over the planes.
template <class Real, bool rubbed, bool boxed>
struct BeginSubstep {
  BodyView<Real> bodies;
  const StoredContact<Real>* soft;
  ContactsByBodyView by_body;
  SoftWalls<Real, rubbed, boxed> walls;
  Vector3<Real> gravity;       ///< m/s^2
  const Vector3<Real>* field;  ///< m/s^2, of attractors, by body; null where the effect is off
  bool pulled;                 ///< gravity or attractors are on
  Real h;                      ///< s
  const StepControl* control;

  SIM_HD void operator()(int id) const {
    if (control->overflow) return;
    begin(id, Given::over(contacts_of(id), entry(id)));
  }

  SIM_HD bool is_long(int id) const { return !control->overflow && contacts_of(id) > long_list; }
#if defined(__CUDACC__)
  __device__ void together(int id) const {
    const Given given = Given::over_together(contacts_of(id), entry(id));
    if (threadIdx.x == 0) begin(id, given);
  }
#endif

 private:
  /// The impulses of its contacts: momentum, with friction also across the normal, and moment.
  using Given = std::conditional_t<rubbed, OrderedSums<Real, 0, 0, 1>, OrderedSums<Real, 0>>;

  SIM_HD std::uint32_t contacts_of(int id) const { return control->contacts > 0 ? by_body.count[id] : 0; }
  SIM_HD auto entry(int id) const {
    return [this, id, radius = walls.bodies.radius[id]](std::uint32_t k, Vector3<Real>* given) {
      const ContactEnd end = by_body.end(id, k);
      const Real sign = end.sign<Real>();
      const StoredContact<Real> contact = load_whole(&soft[end.contact]);
      given[0] = sign * contact.impulse * contact.normal;
      if constexpr (rubbed) {
        given[1] = sign * contact.rubbed;
        given[2] = -((radius + contact.gap / 2) * contact.normal.cross(contact.rubbed));
      }
    };
  }

  SIM_HD void begin(int id, const Given& given) const {
    typename SoftWalls<Real, rubbed, boxed>::Body body = walls.load(id);
    const Vector3<Real> before = body.v;
    SoftWalls<Real, rubbed, boxed> own = walls;
    if (field != nullptr) own.gravity = gravity + field[id];
    if (pulled) body.v += h * own.gravity;
    if constexpr (boxed) own.face_boxes(id, body);
    own.warm_start(id, body);
    if (contacts_of(id) > 0) {
      body.v += body.inverse_mass * given.sum[0];
      if constexpr (rubbed) body.spin.turn(given.sum[1]);
    }
    own.solve(id, body, false, &before);
    body.given = true;
    walls.store(id, body);
  }
};

}  // namespace collidoscope

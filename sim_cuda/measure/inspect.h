#pragma once
// Reads one body from the device: quantities, contacts, position in the tree (World::inspect).

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/executor.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/measure/body_report.h"
#include "sim_cuda/narrow_phase/contact_list.h"
#include "sim_cuda/solver/contact_impulses.h"

namespace collidoscope {

/// Data of a world for inspect(), in the executor's memory.
template <class Real>
struct InspectSource {
  BodyView<Real> bodies;
  std::int64_t body_count;
  Vector3d gravity;  ///< m/s^2
  ContactView<Real> contacts;
  ItemCount contact_count;
  ImpulseView<Real> impulses;  ///< of the last step
  TreeView tree;
};

/// Waits for the device. Precondition: `id` < body_count. Lists the first 1,024 contacts by the other's id,
/// and counts all contacts.
template <class Real>
BodyReport inspect(Executor& executor, const InspectSource<Real>& source, std::uint32_t id);

}  // namespace collidoscope

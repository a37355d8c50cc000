#pragma once
// Packs draw records (publish.h) from the buffers of a world, on the device.

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/narrow_phase/contact_list.h"
#include "sim_cuda/publish/publish.h"
#include "sim_cuda/solver/contact_impulses.h"
#include "sim_cuda/solver/joint_state.h"
#include "sim_cuda/solver/sleeping.h"

namespace collidoscope {

/// Data of a world to be drawn, in the executor's memory.
template <class Real>
struct PackSource {
  BodyView<Real> bodies;
  std::int64_t body_count;
  const std::uint32_t* mesh;  ///< by body, 0: sphere; null: all are spheres
  ContactView<Real> contacts;
  ItemCount contact_count;
  ImpulseView<Real> impulses;  ///< of the last step
  TreeView tree;               ///< used for boxes, and for body colours from the tree
  TreeValues values;
  JointView<Real> joints;
  Vector3<Real> gravity;  ///< direction of rope sag, m/s^2
  SleepView sleep;
  const float* errors;  ///< by id, m; null: all 0
};

/// Enqueues the packing; does not wait. `counts`: scratch, resized if bodies are coloured by contacts.
template <class Real>
void pack(Executor& executor, const PublishTarget& target, const PackSource<Real>& source,
          Buffer<std::uint32_t>& counts);

}  // namespace collidoscope

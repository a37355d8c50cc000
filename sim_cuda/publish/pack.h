#pragma once
// Packs what is drawn (publish.h) from the buffers of a world, on the device.

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/narrow_phase/contact_list.h"
#include "sim_cuda/publish/publish.h"
#include "sim_cuda/solver/contact_impulses.h"
#include "sim_cuda/solver/joint_state.h"
#include "sim_cuda/solver/sleeping.h"

namespace collidoscope {

/// What there is to draw. All pointers are in the executor's memory.
template <class Real>
struct PackSource {
  BodyView<Real> bodies;
  std::int64_t body_count;
  const std::uint32_t* mesh;  ///< null: all are spheres
  ContactView<Real> contacts;
  ItemCount contact_count;
  ImpulseView<Real> impulses;  ///< of the last step
  TreeView tree;               ///< needed for boxes, and for bodies coloured by it
  TreeValues values;
  JointView<Real> joints;
  Vector3<Real> gravity;  ///< m/s^2, which ropes sag along
  SleepView sleep;
  const float* errors;  ///< m, by id; null: 0
};

/// Only enqueues. `counts` is scratch, sized here where bodies are coloured by their contacts.
template <class Real>
void pack(Executor& executor, const PublishTarget& target, const PackSource<Real>& source,
          Buffer<std::uint32_t>& counts);

}  // namespace collidoscope

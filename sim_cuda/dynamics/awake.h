#pragma once
// Stages over the bodies, or over the contacts, that are awake: the stage itself, and which bodies it leaves
// out.

#include <cstdint>

#include "sim_cuda/core/executor.h"
#include "sim_cuda/core/pair.h"

namespace collidoscope {

template <class Stage>
struct OfAwakeBodies {
  Stage stage;
  const std::uint8_t* asleep;  ///< by body: 1 where it sleeps; null where the effect is off
  SIM_HD bool is_awake(int body) const { return asleep == nullptr || !asleep[body]; }
  SIM_HD void operator()(int body) const {
    if (is_awake(body)) stage(body);
  }

  SIM_HD bool is_large(int body) const requires LargeItems<Stage> {
    return is_awake(body) && stage.is_large(body);
  }
#if defined(__CUDACC__)
  __device__ void process_by_block(int body) const requires LargeItems<Stage> {
    stage.process_by_block(body);
  }
#endif
};

/// The two bodies of a contact sleep together, or neither does, except for a static body.
template <class Stage>
struct OfAwakeContacts {
  Stage stage;
  const Pair* contacts;
  const std::uint8_t* asleep;
  SIM_HD void operator()(int contact) const {
    if (asleep == nullptr || (!asleep[contacts[contact].a] && !asleep[contacts[contact].b])) stage(contact);
  }
};

#if !SIM_CUDA || defined(__CUDACC__)  // as Executor::run
/// `asleep`: as OfAwakeBodies::asleep.
template <class Stage>
void run_awake_bodies(Executor& executor, const char* name, std::int64_t bodies, const std::uint8_t* asleep,
                      const Stage& stage) {
  executor.run(name, bodies, OfAwakeBodies<Stage>{stage, asleep});
}

template <class Stage>
void run_awake_contacts(Executor& executor, const char* name, const ItemCount& count, const Pair* contacts,
                        const std::uint8_t* asleep, const Stage& stage) {
  executor.run(name, count, OfAwakeContacts<Stage>{stage, contacts, asleep});
}
#endif

}  // namespace collidoscope

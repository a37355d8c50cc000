#pragma once
// Stages over the bodies, or over the contacts, that are awake: the stage itself, told whom to leave out.
// Where nothing sleeps it runs as it is.

#include <cstdint>

#include "sim_cuda/core/executor.h"
#include "sim_cuda/core/pair.h"
#include "sim_cuda/scene/effects.h"

namespace collidoscope {

template <class Stage>
struct OfAwakeBodies {
  Stage stage;
  const std::uint8_t* asleep;
  SIM_HD void operator()(int body) const {
    if (!asleep[body]) stage(body);
  }

  SIM_HD bool is_long(int body) const requires LongItems<Stage> {
    return !asleep[body] && stage.is_long(body);
  }
#if defined(__CUDACC__)
  __device__ void together(int body) const requires LongItems<Stage> { stage.together(body); }
#endif
};

/// The two bodies of a contact sleep together, or neither does, but for one that no force moves.
template <class Stage>
struct OfAwakeContacts {
  Stage stage;
  const Pair* contacts;
  const std::uint8_t* asleep;
  SIM_HD void operator()(int contact) const {
    if (!asleep[contacts[contact].a] && !asleep[contacts[contact].b]) stage(contact);
  }
};

#if !SIM_CUDA || defined(__CUDACC__)  // as Executor::run
/// `asleep`: 1 for each body that sleeps; null where nothing does.
template <class Stage>
void run_awake_bodies(Executor& executor, const char* name, std::int64_t bodies, const std::uint8_t* asleep,
                      const Stage& stage) {
  if constexpr (built_effects.sleeping)
    if (asleep != nullptr) return executor.run(name, bodies, OfAwakeBodies<Stage>{stage, asleep});
  executor.run(name, bodies, stage);
}

template <class Stage>
void run_awake_contacts(Executor& executor, const char* name, const Count& count, const Pair* contacts,
                        const std::uint8_t* asleep, const Stage& stage) {
  if constexpr (built_effects.sleeping)
    if (asleep != nullptr) return executor.run(name, count, OfAwakeContacts<Stage>{stage, contacts, asleep});
  executor.run(name, count, stage);
}
#endif

}  // namespace collidoscope

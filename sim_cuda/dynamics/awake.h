#pragma once
// Wraps a stage over bodies or contacts so that it skips sleeping bodies.

#include <cstdint>

#include "sim_cuda/core/executor.h"
#include "sim_cuda/core/pair.h"

namespace collidoscope {

template <class Stage>
struct OfAwakeBodies {
  Stage stage;
  const std::uint8_t* asleep;  ///< by body: 1 if it sleeps; null if the effect is off
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

/// The bodies of a contact are both asleep or both awake, except for static bodies.
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
/// `asleep`: see OfAwakeBodies::asleep.
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

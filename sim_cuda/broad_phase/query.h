#pragma once
// The two stages that every broad phase shares: count a body's pairs, then write them. A method brings a
// Query:
//
//   std::uint32_t body(int slot) const;                          the body that query number `slot` is about
//   template <class Visit> void operator()(int slot, Visit&&) const;  calls visit(id) for every body whose
//   box overlaps it
//
// Slots run over 0 .. N-1 in whatever order is kind to the caches. The body itself may be visited; ids <= its
// own are dropped here, so that each pair is written once, by the smaller id.

#include <cstdint>

#include "sim_cuda/core/executor.h"
#include "sim_cuda/core/step_control.h"

namespace collidoscope {

template <class Query>
struct CountPairs {
  Query query;
  std::uint32_t* count;
  SIM_HD void operator()(int slot) const {
    const std::uint32_t body = query.body(slot);
    std::uint32_t found = 0;
    query(slot, [&](std::uint32_t other) { found += other > body; });
    count[body] = found;
  }
};

template <class Query>
struct WritePairs {
  Query query;
  const std::uint64_t* offset;
  std::uint32_t* second;
  const StepControl* control;
  SIM_HD void operator()(int slot) const {
    if (control->overflow) return;
    const std::uint32_t body = query.body(slot);
    std::uint64_t at = offset[body];
    if (at == offset[body + 1]) return;
    query(slot, [&](std::uint32_t other) {
      if (other > body) second[at++] = other;
    });
  }
};

}  // namespace collidoscope

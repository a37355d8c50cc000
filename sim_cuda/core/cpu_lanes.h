#pragma once
// CPU loop over the items of a stage, with the stage's type erased. Each stage is compiled into a single
// loop, which serves all item orders. Reason: four loops per stage take four times as long to compile.

#include <cstdint>

#include "sim_cuda/core/executor_options.h"
#include "sim_cuda/core/parallel_for.h"

namespace collidoscope {

/// Approximate number of items that a thread takes at a time.
inline constexpr std::int64_t usual_chunk = 512;

/// Calls a stage for `count` items: first, first + stride, first + 2 stride, ...
using ItemLoop = void (*)(const void* stage, std::int64_t first, std::int64_t stride, std::int64_t count);

/// Runs `loop` over the items [0, count) in chunks of `chunk` items, on all threads of `team`.
void run_in_chunks(ThreadTeam& team, std::int64_t count, std::int64_t chunk, ItemLoop loop,
                   const void* stage);

/// Runs `loop` over the items [0, count), distributed over `lanes` lanes in the given order. Each lane checks
/// for cancellation every `chunk` items.
void run_in_lanes(ThreadTeam& team, std::int64_t count, std::int64_t lanes, LaneOrder order,
                  std::int64_t chunk, ItemLoop loop, const void* stage);

}  // namespace collidoscope

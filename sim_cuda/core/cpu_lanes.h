#pragma once
// The loop of one stage on the CPU, without the stage's type: each stage is compiled into one loop, whatever
// the order of its items. Reason: compile time; a stage in four loops takes four times as long to compile.

#include <cstdint>

#include "sim_cuda/core/executor_options.h"
#include "sim_cuda/core/parallel_for.h"

namespace collidoscope {

/// Calls a stage for the items first, first + stride, ...: `count` of them.
using ItemLoop = void (*)(const void* stage, std::int64_t first, std::int64_t stride, std::int64_t count);

/// Runs `loop` over the items [0, count) in chunks of `chunk` items, on all threads of `team`.
void run_in_chunks(ThreadTeam& team, std::int64_t count, std::int64_t chunk, ItemLoop loop,
                   const void* stage);

/// Runs `loop` over the items [0, count), divided among `lanes` lanes in that order; a lane looks for a
/// cancellation after each `chunk` items.
void run_in_lanes(ThreadTeam& team, std::int64_t count, std::int64_t lanes, LaneOrder order,
                  std::int64_t chunk, ItemLoop loop, const void* stage);

}  // namespace collidoscope

#pragma once
// Stages of several rounds, each over all its items before the next begins (Executor::run_rounds): the
// contract, as concepts, and the GPU kernels with their launches.
//
// On a GPU all rounds are one launch, whose threads wait for each other between rounds. A round of no items
// costs no wait. Where the (B, T) asked for is more than runs at once, each round is a launch of its own.
// (A cluster of blocks waits for less time, but has at most 16 multiprocessors, and only their share of the
// memory bandwidth: slower from 50,000 bodies on.)

#include <concepts>
#include <cstdint>

#include "sim_cuda/core/host_device.h"
#include "sim_cuda/core/item_kernels.h"

#if defined(__CUDACC__)
#include <cooperative_groups.h>

#include <string>

#include "sim_cuda/core/cuda_check.h"
#include "sim_cuda/core/launch_planner.h"
#endif

namespace collidoscope {

/// What every stage of several rounds has:
///
///   SIM_HD std::int64_t items(int round) const;  // called when the rounds before are done, unless planned
///   SIM_HD void operator()(int round, int item) const;
///
/// The items of one round must not depend on each other.
template <class Rounds>
concept ItemRounds = requires(const Rounds& rounds, int number) {
  { rounds.items(number) } -> std::convertible_to<std::int64_t>;
  rounds(number, number);
};

/// No round changes the number of items of a later one. On a GPU one block alone then executes consecutive
/// rounds of few items, and no other block waits for it between them:
///
///   static constexpr bool planned = true;
template <class Rounds>
concept PlannedRounds = ItemRounds<Rounds> && requires {
  requires Rounds::planned;
};

/// The first rounds are split into reading and doing, so that an item is read before its turn:
///
///   static constexpr int fetched;  // the number of these rounds
///   SIM_HD Fetched fetch(int round, int item) const;  // reads what no item but this one writes in any round
///   SIM_HD void operator()(Fetched) const;
template <class Rounds>
concept FetchingRounds = PlannedRounds<Rounds> && requires {
  typename Rounds::Fetched;
};

/// On a GPU the first rounds are executed as a chain: an item starts as soon as the items that it needs are
/// done, without a wait for whole rounds. take_turn() is needed only where nvcc compiles.
///
///   static constexpr int chained;  // the number of these rounds; 0: no chain
///   static constexpr bool chained_beyond_threads;  // also where `most` items are more than threads at once
///   SIM_HD std::int64_t chained_items() const;  // of all these rounds, numbered in the order of the rounds
///   SIM_HD Fetched fetch(std::uint32_t item) const;
///   __device__ bool take_turn(Fetched&) const;  // true: did the item, since all that it needs are done
template <class Rounds>
concept ChainedRounds = FetchingRounds<Rounds> &&(Rounds::chained > 0);

/// One round has long items (LongItems). It is called without its number, as operator()(item):
///
///   static constexpr int long_round;  // from 0; negative: none
template <class Rounds>
concept RoundsOfLongItems = PlannedRounds<Rounds> && LongItems<Rounds> &&(Rounds::long_round >= 0);

template <class Rounds>
SIM_HD void run_item(const Rounds& rounds, int round, int item) {
  if constexpr (FetchingRounds<Rounds>)
    if (round < Rounds::fetched) return rounds(rounds.fetch(round, item));
  if constexpr (RoundsOfLongItems<Rounds>)
    if (round == Rounds::long_round) return rounds(item);
  rounds(round, item);
}

/// One round as a stage.
template <class Rounds>
struct OneRound {
  Rounds rounds;
  int round;
  SIM_HD void operator()(int item) const { run_item(rounds, round, item); }
};

#if defined(__CUDACC__)

template <class Rounds>
__device__ void run_rounds_in(const cooperative_groups::grid_group& grid, const int rounds,
                              const Rounds& stage) {
  const auto rank = static_cast<std::int64_t>(grid.thread_rank());
  const auto lanes = static_cast<std::int64_t>(grid.size());
  for (int round = 0; round < rounds; ++round) {
    const std::int64_t items = stage.items(round);
    if (items == 0) continue;
    for (std::int64_t i = rank; i < items; i += lanes) stage(round, static_cast<int>(i));
    grid.sync();
  }
}

template <class Rounds>
__device__ void run_items_of(const Rounds& stage, int round, std::int64_t first, std::int64_t items,
                             std::int64_t stride) {
  if constexpr (RoundsOfLongItems<Rounds>)
    if (round == Rounds::long_round) return run_items(first, items, stride, stage);
  for (std::int64_t i = first; i < items; i += stride) run_item(stage, round, static_cast<int>(i));
}

/// The first block alone executes each round of so few items that this takes less time than a grid-wide wait.
template <class Rounds>
requires PlannedRounds<Rounds> __device__ void run_rounds_in(const cooperative_groups::grid_group& grid,
                                                             const int rounds, const Rounds& stage) {
  const auto rank = static_cast<std::int64_t>(grid.thread_rank());
  const auto lanes = static_cast<std::int64_t>(grid.size());
  bool first = true, was_alone = false;
  for (int round = 0; round < rounds; ++round) {
    const std::int64_t items = stage.items(round);
    if (items == 0) continue;
    const bool alone = items <= (blockDim.x > 768 ? blockDim.x : 768);
    if (!first && !(alone && was_alone)) grid.sync();
    if (!first && alone && was_alone && rank < blockDim.x) __syncthreads();
    first = false;
    was_alone = alone;
    if (alone && rank >= blockDim.x) continue;
    run_items_of(stage, round, rank, items, alone ? std::int64_t{blockDim.x} : lanes);
  }
}

template <class Rounds>
__global__ void __launch_bounds__(1024, 1) run_all_rounds(const int rounds, const Rounds stage) {
  run_rounds_in(cooperative_groups::this_grid(), rounds, stage);
}

/// Executes rounds [0, chained) as a chain, then the others. There is no deadlock: all threads run at once,
/// and each takes its items in increasing order. Of the items that are not done, the first therefore needs
/// none of the others, and its thread has reached it.
template <ChainedRounds Rounds>
__global__ void __launch_bounds__(1024, 1) run_chain(const int rounds, const Rounds stage) {
  const cooperative_groups::grid_group grid = cooperative_groups::this_grid();
  const auto rank = static_cast<std::int64_t>(grid.thread_rank());
  const auto lanes = static_cast<std::int64_t>(grid.size());
  const std::int64_t chained = stage.chained_items();
  for (std::int64_t i = rank; i < chained; i += lanes) {
    typename Rounds::Fetched item = stage.fetch(static_cast<std::uint32_t>(i));
    // take_turn() does the item within the loop, because a lane of the same warp may be waiting for it.
    bool done = false;
    while (!done) done = stage.take_turn(item);
  }
  for (int round = Rounds::chained; round < rounds; ++round) {
    const std::int64_t items = stage.items(round);
    if (items == 0) continue;
    grid.sync();
    run_items_of(stage, round, rank, items, lanes);
  }
}

template <class Rounds>
__global__ void __launch_bounds__(1024, 1) run_one_round(const int round, const Rounds stage) {
  run_items_of(stage, round, std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x, stage.items(round),
               std::int64_t{gridDim.x} * blockDim.x);
}

/// `most` items in a round determine (B, T).
template <class Rounds>
void launch_rounds(LaunchPlanner& planner, cudaStream_t stream, const char* name, int rounds,
                   std::int64_t most, const Rounds& stage) {
  const auto launch_together = [&](void (*kernel)(int, Rounds), int blocks_each) {
    const auto all = reinterpret_cast<const void*>(kernel);
    const LaunchShape shape = planner.choose_waiting_shape(all, name, most, blocks_each);
    if (shape.blocks == 0) return false;
    const void* arguments[] = {&rounds, &stage};
    check(cudaLaunchCooperativeKernel(all, dim3(static_cast<unsigned>(shape.blocks)),
                                      dim3(static_cast<unsigned>(shape.threads)),
                                      const_cast<void**>(arguments), 0, stream),
          std::string("launch stage ") + name);
    check_launch(name, shape);
    return true;
  };
  if constexpr (ChainedRounds<Rounds>)
    if (Rounds::chained_beyond_threads || most <= planner.threads_at_once())
      if (launch_together(&run_chain<Rounds>, 2)) return;
  if (launch_together(&run_all_rounds<Rounds>, 1)) return;
  const auto one = reinterpret_cast<const void*>(&run_one_round<Rounds>);
  for (int round = 0; round < rounds; ++round) {
    const LaunchShape shape = planner.choose_shape(one, name, most, true, nullptr);
    run_one_round<Rounds><<<shape.blocks, shape.threads, 0, stream>>>(round, stage);
    check_launch(name, shape);
  }
}

#endif

}  // namespace collidoscope

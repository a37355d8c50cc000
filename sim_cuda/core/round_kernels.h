#pragma once
// Multi-round stages (Executor::run_rounds): a round starts after all items of the previous round are done.
// This file has the concepts that describe them, and the GPU kernels with their launches.
//
// On a GPU, all rounds run in one cooperative launch with a grid barrier between rounds. Empty rounds skip
// the barrier. If the requested (B, T) exceeds the resident blocks, each round is a separate launch.
//
// Thread block clusters have faster barriers, but at most 16 multiprocessors and their share of the memory
// bandwidth. They are slower from 50,000 bodies on.

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

/// Interface of every multi-round stage:
///
///   SIM_HD std::int64_t items(int round) const;  // called after the previous round
///   SIM_HD void operator()(int round, int item) const;
///
/// A negative number of items ends the stage, except if the item counts are fixed (StaticRounds).
/// Precondition: the items of one round are independent.
template <class Rounds>
concept ItemRounds = requires(const Rounds& rounds, int number) {
  { rounds.items(number) } -> std::convertible_to<std::int64_t>;
  rounds(number, number);
};

/// The item counts are fixed, so items() may be called at any time. On a GPU, one block runs consecutive
/// small rounds alone, without grid barriers between them:
///
///   static constexpr bool static_item_counts = true;
template <class Rounds>
concept StaticRounds = ItemRounds<Rounds> && requires {
  requires Rounds::static_item_counts;
};

/// Rounds in which few items act: their time is that of the barriers, which grows with the threads of a
/// block.
///
///   static constexpr int most_threads;  // per block, with automatic T
template <class Rounds>
concept RoundsOfFewItems = ItemRounds<Rounds> && requires {
  Rounds::most_threads;
};

/// After some rounds, one block may run all rounds that are left faster than the whole grid:
///
///   static constexpr bool has_short_rest = true;
///   SIM_HD bool rest_is_short(int round) const;  // called after a round with items; same in all threads
///   __device__ void run_rest(int round) const;   // the rounds after this one, by the threads of one block
template <class Rounds>
concept RoundsWithShortRest = ItemRounds<Rounds> && requires {
  requires Rounds::has_short_rest;
};

/// The first rounds split an item into fetch and process, so that its operands can be loaded early:
///
///   static constexpr int prefetched_rounds;  // number of these rounds
///   SIM_HD Operands fetch(int round, int item) const;  // reads only data that no other item writes
///   SIM_HD void operator()(Operands) const;
template <class Rounds>
concept PrefetchingRounds = StaticRounds<Rounds> && requires {
  typename Rounds::Operands;
};

/// On a GPU, the first rounds run without barriers: an item starts as soon as the items that it depends on
/// are done. try_process() is needed only for nvcc.
///
///   static constexpr int sync_free_rounds;  // number of these rounds; 0: none
///   static constexpr bool sync_free_beyond_threads;  // also if `max_items` exceeds the resident threads
///   SIM_HD std::int64_t sync_free_items() const;  // in all these rounds, numbered in the order of rounds
///   SIM_HD Operands fetch(std::uint32_t item) const;
///   __device__ bool try_process(Operands&) const;  // true: the item was ready, and is done
template <class Rounds>
concept SyncFreeRounds = PrefetchingRounds<Rounds> &&(Rounds::sync_free_rounds > 0);

/// One round has large items (LargeItems). It is called without the round number, as operator()(item):
///
///   static constexpr int large_item_round;  // from 0; negative: none
template <class Rounds>
concept RoundsWithLargeItems = StaticRounds<Rounds> && LargeItems<Rounds> &&(Rounds::large_item_round >= 0);

/// Bytes beside the items of a round. Items with a lower byte than `least` do nothing.
struct ItemMarks {
  const std::uint8_t* by_item = nullptr;  ///< values up to 127; null: all items may act
  std::uint8_t least = 1;                 ///< 1 to 127
};

/// A round may have few items that act. The CPU calls only these:
///
///   Stage round(int number) const;  // called after the previous round; a stage with:
///   ItemMarks marks() const;
template <class Rounds>
concept MarkedRounds = ItemRounds<Rounds> && requires(const Rounds& rounds, int number) {
  { rounds.round(number).marks() } -> std::same_as<ItemMarks>;
};

template <class Rounds>
SIM_HD void run_item(const Rounds& rounds, int round, int item) {
  if constexpr (PrefetchingRounds<Rounds>)
    if (round < Rounds::prefetched_rounds) return rounds(rounds.fetch(round, item));
  if constexpr (RoundsWithLargeItems<Rounds>)
    if (round == Rounds::large_item_round) return rounds(item);
  rounds(round, item);
}

/// Adapts one round to a stage.
template <class Rounds>
struct OneRound {
  Rounds rounds;
  int round;
  SIM_HD void operator()(int item) const { run_item(rounds, round, item); }
};

/// Adapts a list of items of a stage to a stage. `items` null: all items.
template <class Stage>
struct ListedItems {
  Stage stage;
  const int* items;
  void operator()(int k) const { stage(items == nullptr ? k : items[k]); }  // on the CPU only
  std::int64_t items_per_chunk() const requires requires { stage.items_per_chunk(); }
  { return stage.items_per_chunk(); }
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
    if (items < 0) return;
    for (std::int64_t i = rank; i < items; i += lanes) stage(round, static_cast<int>(i));
    grid.sync();
    if constexpr (RoundsWithShortRest<Rounds>)
      if (stage.rest_is_short(round)) {
        if (blockIdx.x == 0) stage.run_rest(round);
        return;
      }
  }
}

template <class Rounds>
__device__ void run_items_of(const Rounds& stage, int round, std::int64_t first, std::int64_t items,
                             std::int64_t stride) {
  if constexpr (RoundsWithLargeItems<Rounds>)
    if (round == Rounds::large_item_round) return run_items(first, items, stride, stage);
  for (std::int64_t i = first; i < items; i += stride) run_item(stage, round, static_cast<int>(i));
}

/// Rounds small enough that a grid barrier costs more than running them on one block are run by block 0 only.
template <class Rounds>
requires StaticRounds<Rounds> __device__ void run_rounds_in(const cooperative_groups::grid_group& grid,
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

/// Runs rounds [0, sync_free_rounds) in dependency order, then the other rounds. No deadlock: all threads are
/// resident, and each processes its items in increasing order. The lowest-numbered unfinished item depends on
/// finished items only, and its thread has reached it.
template <SyncFreeRounds Rounds>
__global__ void __launch_bounds__(1024, 1) run_dependency_ordered(const int rounds, const Rounds stage) {
  const cooperative_groups::grid_group grid = cooperative_groups::this_grid();
  const auto rank = static_cast<std::int64_t>(grid.thread_rank());
  const auto lanes = static_cast<std::int64_t>(grid.size());
  const std::int64_t sync_free = stage.sync_free_items();
  for (std::int64_t i = rank; i < sync_free; i += lanes) {
    typename Rounds::Operands item = stage.fetch(static_cast<std::uint32_t>(i));
    // Process within the loop, because another lane of the same warp may wait for this item.
    bool done = false;
    while (!done) done = stage.try_process(item);
  }
  for (int round = Rounds::sync_free_rounds; round < rounds; ++round) {
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

/// (B, T) is chosen for `max_items` items per round.
template <class Rounds>
void launch_rounds(LaunchPlanner& planner, cudaStream_t stream, const char* name, int rounds,
                   std::int64_t max_items, const Rounds& stage) {
  const auto launch_cooperative = [&](void (*kernel)(int, Rounds), int blocks_per_multiprocessor) {
    const auto all = reinterpret_cast<const void*>(kernel);
    int most_threads = 1024;
    if constexpr (RoundsOfFewItems<Rounds>) most_threads = Rounds::most_threads;
    const LaunchShape shape =
        planner.choose_cooperative_shape(all, name, max_items, blocks_per_multiprocessor, most_threads);
    if (shape.blocks == 0) return false;
    const void* arguments[] = {&rounds, &stage};
    check(cudaLaunchCooperativeKernel(all, dim3(static_cast<unsigned>(shape.blocks)),
                                      dim3(static_cast<unsigned>(shape.threads)),
                                      const_cast<void**>(arguments), 0, stream),
          std::string("launch stage ") + name);
    check_launch(name, shape);
    return true;
  };
  if constexpr (SyncFreeRounds<Rounds>)
    if (Rounds::sync_free_beyond_threads || max_items <= planner.threads_at_once())
      if (launch_cooperative(&run_dependency_ordered<Rounds>, 2)) return;
  if (launch_cooperative(&run_all_rounds<Rounds>, 1)) return;
  const auto one = reinterpret_cast<const void*>(&run_one_round<Rounds>);
  for (int round = 0; round < rounds; ++round) {
    const LaunchShape shape = planner.choose_shape(one, name, max_items, true, nullptr);
    run_one_round<Rounds><<<shape.blocks, shape.threads, 0, stream>>>(round, stage);
    check_launch(name, shape);
  }
}

#endif

}  // namespace collidoscope

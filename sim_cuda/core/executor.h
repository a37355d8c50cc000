#pragma once
// An Executor runs stages: on a GPU, or on the threads of the CPU, behind one call. It owns the stream or the
// threads, counts the bytes that buffers take, and tells the StageClock which stage is running. It outlives
// every buffer and graph made on it.
//
//   executor.run("bounds", body_count, BodyBounds{...});
//
// calls BodyBounds::operator()(int item) for every item, B blocks of T threads sharing them (launch_shape.h).
// A stage's items must not depend on each other: any order and any number at a time gives the same result.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/cpu_lanes.h"
#include "sim_cuda/core/executor_options.h"
#include "sim_cuda/core/host_device.h"
#include "sim_cuda/core/occupancy.h"
#include "sim_cuda/core/parallel_for.h"
#include "sim_cuda/core/stage_clock.h"

#if SIM_CUDA
#include "sim_cuda/core/cuda_check.h"
#endif
#if defined(__CUDACC__)
#include <cooperative_groups.h>
#endif

namespace collidoscope {

/// How many items a stage has: known to the host, or the value of a counter in the executor's memory, which
/// the stage reads when it starts, so that the host need not wait for it.
struct Count {
  std::int64_t bound = 0;                  ///< the number of items, or no fewer than it
  const std::uint32_t* counter = nullptr;  ///< where the number stands, if the host does not know it

  Count(std::int64_t items) : bound(items) {}  // NOLINT(google-explicit-constructor): a number is a Count
  Count(const std::uint32_t* where, std::int64_t at_most) : bound(at_most), counter(where) {}
  SIM_HD std::int64_t value() const {
    if (counter == nullptr) return bound;
    const auto items = static_cast<std::int64_t>(*counter);
    return items < bound ? items : bound;
  }
};

/// A stage of which one item may take as long as thousands of others, such as the item of a body that touches
/// thousands. On a GPU the threads of a block do it together, when each has done its own.
///
///   SIM_HD bool is_long(int item) const;
///   __device__ void together(int item) const;  // the same to the bit as operator()(item)
template <class Stage>
concept LongItems = requires(const Stage& stage) {
  stage.is_long(0);
};

class Executor {
 public:
  /// Throws MachineError where the device asked for is not there, InputError where an option makes no sense.
  explicit Executor(const ExecutorOptions& options);
  ~Executor();
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  bool on_device() const { return on_device_; }
  int gpu() const { return on_device_ ? options_.gpu : -1; }
  const std::string& device_name() const { return device_name_; }
  /// How many cores of a CPU would be about as fast.
  double equal_cores() const;
  const ExecutorOptions& options() const { return options_; }
  StageClock& clock() { return clock_; }
  ThreadTeam& team() { return team_; }

  /// Changes (B, T) for the stages enqueued from now on. Throws MachineError beyond the device's limits.
  void set_shape(LaunchShape shape);

  // Memory of this executor's space: the device's, or the host's (64-byte aligned). `name` stands in the
  // error that says how many bytes were asked for. Sizes of zero are allowed.
  void* allocate(const char* name, std::size_t bytes);
  void release(void* memory, std::size_t bytes);
  std::int64_t allocated_bytes() const { return allocated_bytes_; }
  std::map<std::string, std::int64_t> bytes_by_name() const;  ///< what is allocated; names may share a sum

  /// Bytes that may still be taken: what the machine has free, within ExecutorOptions::memory_limit.
  std::int64_t available_bytes() const;
  /// Bytes that buffers may still take by rule: up to ExecutorOptions::memory_limit, else up to 80 % of what
  /// the machine has for this executor; with ExecutorOptions::allow_large all that are available.
  std::int64_t room_bytes() const;
  /// By how much allocated_bytes() would change if `reserve` were called. While it is, buffers keep their
  /// size and their contents, and fills do nothing.
  std::int64_t rehearse(const std::function<void()>& reserve);
  /// The same of buffers that `make` makes, and which do not outlive it: they have a size, but no memory. No
  /// stage may run.
  std::int64_t imagine(const std::function<void()>& make);
  bool imagining() const { return imagining_; }
  bool rehearsing() const { return rehearsing_; }
  void count_rehearsed(std::int64_t bytes) { rehearsed_bytes_ += bytes; }

  // Copies and fills, in the order of the stages. The copies return when they are done; fill() is only
  // enqueued.
  void copy_to_executor(void* destination, const void* host_source, std::size_t bytes);
  void copy_to_host(void* host_destination, const void* source, std::size_t bytes);
  void fill(void* destination, int byte, std::size_t bytes);
  void synchronize();

  // Cancellation (ExecutorOptions::cancellation): stages throw Cancelled, on the CPU at their start or
  // between chunks; on a GPU whatever waits for the device does, and leaves it at work.

  /// Throws Cancelled if that was requested. For work between stages.
  void heed();
  /// Something was cancelled and may be incomplete: buffers that outlive a step, too. On a GPU nothing can be
  /// done with this executor any more.
  bool interrupted() const;
  /// What was incomplete has been made anew.
  void resume() { team_.resume(); }
  /// While one lives, nothing is cancelled.
  class Uninterrupted {
   public:
    explicit Uninterrupted(Executor& executor) : executor_(executor) { executor_.shield(1); }
    ~Uninterrupted() { executor_.shield(-1); }
    Uninterrupted(const Uninterrupted&) = delete;
    Uninterrupted& operator=(const Uninterrupted&) = delete;

   private:
    Executor& executor_;
  };

  /// Stages whose items call themselves need so many bytes of stack a thread beside the usual; outside a
  /// step.
  void reserve_call_stack(std::size_t bytes);

  /// The stage of what is enqueued from here on; what libraries launch themselves ignores (B, T):
  /// `own_shape`.
  void begin_stage(const char* name, bool own_shape = false);
  /// On the CPU: that many parallel loops ran. On a GPU the graph counts its own nodes.
  void count_launches(int launches);
  /// The stages that begin from here on belong to this substep, 0 being the first, and that of what is
  /// watched at first. Nobody but who watches asks.
  void begin_substep(int substep) { substep_ = substep; }

  /// Is told of a stage whose work is enqueued, all of it, and in which substep it began.
  using StageEnded = std::function<void(const char* stage, int substep)>;
  /// Does `work`, and tells `ended` of each stage that begins in it. Stages that `ended` itself begins are
  /// not told of.
  void run_watched(const StageEnded& ended, const std::function<void()>& work);

#if !SIM_CUDA || defined(__CUDACC__)
  /// Runs one stage over all items. Returns when it is done on the CPU, when it is enqueued on a GPU.
  template <class Stage>
  void run(const char* name, const Count& count, const Stage& stage) {
    if (count.bound == 0) return;
    begin_stage(name);
    if (!on_device_) return run_on_cpu(count.value(), stage);
#if defined(__CUDACC__)
    launch(name, count, stage);
#endif
  }
#endif

#if !SIM_CUDA || defined(__CUDACC__)
  /// Runs several rounds of one stage, each over all its items before the next begins:
  ///
  ///   SIM_HD std::int64_t items(int round) const;  // asked when the rounds before are done
  ///   SIM_HD void operator()(int round, int item) const;
  ///   static constexpr bool planned = true;  // where no round changes the items of a later one
  ///   static constexpr int long_round;  // of planned rounds: one with long items (LongItems), done without
  ///                                     // its number: operator()(item)
  ///
  /// The first of planned rounds may part what an item reads from what it does:
  ///
  ///   static constexpr int fetched;  // so many rounds
  ///   SIM_HD Fetched fetch(int round, int item) const;  // what no round writes, but for this item itself
  ///   SIM_HD void operator()(Fetched) const;
  ///
  /// and on a GPU these may be one chain, in which nobody waits for whole rounds:
  ///
  ///   static constexpr int chained;  // so many rounds, or 0
  ///   static constexpr bool chained_beyond_threads;  // also where `most` are more than run at once
  ///   SIM_HD std::int64_t chained_items() const;  // of them all, numbered in their order
  ///   SIM_HD Fetched fetch(std::uint32_t item) const;
  ///   __device__ bool take_turn(Fetched&) const;  // does the item, if all that it needs are done
  ///
  /// `most` items is a round by which the launch is shaped; none: nothing runs.
  ///
  /// On a GPU it is one launch, whose threads wait for each other between rounds, and for nobody at a round
  /// of no items; a block alone does planned rounds of few items, which leaves it nobody to wait for. (A
  /// cluster of blocks waits sooner, but is 16 multiprocessors at most, and their share of the memory's
  /// bandwidth: slower from 50,000 bodies on.) Where B x T threads are more than run at once, it is a launch
  /// a round.
  template <class Rounds>
  void run_rounds(const char* name, int rounds, std::int64_t most, const Rounds& stage);
#endif

#if SIM_CUDA
  cudaStream_t stream() const { return stream_; }
#endif

#if defined(__CUDACC__)
  /// How a kernel that is no stage, but works with warps or shared memory, is launched as B blocks of T.
  struct KernelNeeds {
    std::int64_t threads;                          ///< that would have something to do
    bool at_once;                                  ///< "auto": no more than run at once
    std::size_t (*shared_bytes)(int T) = nullptr;  ///< of a block of T threads
  };
  template <class... Parameters, class... Arguments>
  void run_kernel(const char* name, const KernelNeeds& needs, void (*kernel)(Parameters...),
                  const Arguments&... arguments);
#endif

 private:
  friend class StepGraph;

  /// On the CPU, "auto": items that a thread takes at a time, about.
  static constexpr std::int64_t cpu_chunk = 512;
  template <class Stage>
  void run_on_cpu(std::int64_t count, const Stage& stage);
  void run_loop(std::int64_t count, const void* stage, ItemLoop loop);
  /// One more parallel loop of the stage in progress: `lanes` of them share the items; 0: chunks.
  void count_loop(std::int64_t items, std::int64_t lanes);
#if defined(__CUDACC__)
  template <class Stage>
  void launch(const char* name, const Count& count, const Stage& stage);
  template <class Rounds>
  void launch_rounds(const char* name, int rounds, std::int64_t most, const Rounds& stage);
#endif
  void end_stage();
  void close_stage();
  void shield(int more);
  /// Where a step was cancelled in its middle.
  void leave_stage();

  ExecutorOptions options_;
  bool on_device_ = false;
  std::string device_name_;
  std::int64_t allocated_bytes_ = 0;
  struct Allocation {
    const char* name;
    std::size_t bytes;
  };
  std::unordered_map<const void*, Allocation> allocations_;
  bool rehearsing_ = false, imagining_ = false;
  std::int64_t rehearsed_bytes_ = 0;
  int shields_ = 0;
  ThreadTeam team_;
  StageClock clock_;

  // The stage in progress.
  const char* stage_ = nullptr;
  std::size_t stage_entry_ = 0;
  int substep_ = 0, stage_substep_ = 0;
  const StageEnded* watch_ = nullptr;  ///< null: nobody watches, or is told at this moment
  bool timing_ = false;                ///< CPU: read the clock at every change of stage
  bool counting_ = false;              ///< count launches per stage
  std::chrono::steady_clock::time_point stage_start_;
#if SIM_CUDA
  /// What the device says of a kernel in blocks of so many threads.
  struct KernelFit {
    int threads, registers, shared_bytes, resident_blocks;
    double occupancy;
    LaunchLimit limit;
  };
  using SharedBytes = std::size_t (*)(int threads);  ///< that a block takes when it is launched; may be null
  /// `threads` 0: the number, 128 at most, of which most run at once. Each kernel is asked about once.
  const KernelFit& kernel_fit(const void* kernel, int threads, const char* name, SharedBytes shared);
  /// (B, T) for so many items, with "auto" decided; notes it, if a step is being recorded.
  LaunchShape choose_shape(const void* kernel, const char* name, std::int64_t items, bool at_once,
                           SharedBytes shared);
  /// (B, T) for threads that wait for each other, `blocks_each` to a multiprocessor; B = 0: it would be more
  /// than run at once.
  LaunchShape choose_waiting_shape(const void* kernel, const char* name, std::int64_t items, int blocks_each);
  void note_shape(std::int64_t items, LaunchShape shape, const KernelFit& fit);
  void check_launch(const char* name, LaunchShape shape);
  std::map<std::pair<const void*, int>, KernelFit> fits_;
  MultiprocessorLimits limits_;
  int multiprocessors_ = 0;
  /// That kernels in need of 64 registers a thread have.
  std::int64_t threads_at_once() const { return std::int64_t{1024} * multiprocessors_; }

  int max_threads_ = 1024, max_blocks_ = 2147483647;
  cudaStream_t stream_ = nullptr;
  class StepGraph* recording_ = nullptr;
  std::size_t nodes_in_capture() const;
  std::size_t stage_nodes_ = 0;
#endif
};

/// A step, recorded once and launched often: a CUDA graph, or on the CPU simply the function. An instrumented
/// one also measures each of its stages.
class StepGraph {
 public:
  /// `enqueue` runs stages on `executor`; it must not allocate, copy to or from the host, or wait.
  StepGraph(Executor& executor, bool instrumented, std::function<void()> enqueue);
  ~StepGraph();
  StepGraph(const StepGraph&) = delete;
  StepGraph& operator=(const StepGraph&) = delete;

  void launch();
  /// After an instrumented launch has finished: gives its times to the executor's clock (which still needs
  /// commit_step()).
  void collect();

 private:
  friend class Executor;
  Executor& executor_;
  bool instrumented_;
  std::function<void()> enqueue_;
#if SIM_CUDA
  void mark(std::size_t entry);
  cudaGraphExec_t graph_ = nullptr;
  std::vector<cudaEvent_t> events_;         ///< one at the start of each run of a stage, one at the end
  std::vector<std::size_t> event_entries_;  ///< which stage starts there
#endif
};

// ---- implementation of the templates ----

template <class Stage>
void Executor::run_on_cpu(std::int64_t count, const Stage& stage) {
  run_loop(count, &stage, [](const void* one, std::int64_t first, std::int64_t stride, std::int64_t items) {
    const Stage& s = *static_cast<const Stage*>(one);
    for (std::int64_t k = 0; k < items; ++k) s(static_cast<int>(first + k * stride));
  });
}

template <class Rounds>
concept PlannedRounds = requires {
  requires Rounds::planned;
};

template <class Rounds>
concept FetchingRounds = PlannedRounds<Rounds> && requires {
  typename Rounds::Fetched;
};

template <class Rounds>
concept ChainedRounds = FetchingRounds<Rounds> &&(Rounds::chained > 0);

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

template <class Rounds>
struct OneRound {
  Rounds rounds;
  int round;
  SIM_HD void operator()(int item) const { run_item(rounds, round, item); }
};

#if !SIM_CUDA || defined(__CUDACC__)
template <class Rounds>
void Executor::run_rounds(const char* name, int rounds, std::int64_t most, const Rounds& stage) {
  if (most == 0) return;
  begin_stage(name);
#if defined(__CUDACC__)
  if (on_device_) return launch_rounds(name, rounds, most, stage);
#endif
  for (int round = 0; round < rounds; ++round)
    if (const std::int64_t items = stage.items(round); items > 0)
      run_on_cpu(items, OneRound<Rounds>{stage, round});
}
#endif

#if defined(__CUDACC__)

/// A thread's own items: `first` and every `stride`-th from there on.
template <class Stage>
__device__ void run_items(std::int64_t first, std::int64_t items, std::int64_t stride, const Stage& stage) {
  for (std::int64_t i = first; i < items; i += stride) stage(static_cast<int>(i));
}
template <LongItems Stage>
__device__ void run_items(std::int64_t first, std::int64_t items, std::int64_t stride, const Stage& stage) {
  constexpr std::uint32_t room = 64;  // who finds it full does the item alone
  __shared__ int waiting[room];
  __shared__ std::uint32_t waits;
  if (threadIdx.x == 0) waits = 0;
  __syncthreads();
  for (std::int64_t i = first; i < items; i += stride) {
    const int item = static_cast<int>(i);
    if (stage.is_long(item))
      if (const std::uint32_t place = atomicAdd(&waits, 1); place < room) {
        waiting[place] = item;
        continue;
      }
    stage(item);
  }
  __syncthreads();
  const std::uint32_t all = waits < room ? waits : room;
  for (std::uint32_t k = 0; k < all; ++k) {
    stage.together(waiting[k]);
    __syncthreads();
  }
}

/// B x T threads stride over the items, as in the paper. At most 64 registers, so that every T up to 1024 can
/// be launched.
template <class Stage>
__global__ void __launch_bounds__(1024, 1) run_stage(const Count count, const Stage stage) {
  run_items(static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x, count.value(),
            static_cast<std::int64_t>(gridDim.x) * blockDim.x, stage);
}

template <class Stage>
void Executor::launch(const char* name, const Count& count, const Stage& stage) {
  const auto kernel = reinterpret_cast<const void*>(&run_stage<Stage>);
  // Where the count is only a capacity, no more than run at once: most would find nothing to do.
  const LaunchShape shape = choose_shape(kernel, name, count.bound, count.counter != nullptr, nullptr);
  run_stage<Stage><<<shape.blocks, shape.threads, 0, stream_>>>(count, stage);
  check_launch(name, shape);
}

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

/// Of rounds whose items are known from the start, those that one block does sooner than it could wait for
/// the others are its alone.
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

/// Rounds [0, chained) as one: their items in their order, each as soon as those that it needs are done,
/// which take_turn() finds out. Nobody waits for ever: of the items that are not done, the first needs none
/// of the others, and its thread, which takes its own in order, is at it.
template <ChainedRounds Rounds>
__global__ void __launch_bounds__(1024, 1) run_chain(const int rounds, const Rounds stage) {
  const cooperative_groups::grid_group grid = cooperative_groups::this_grid();
  const auto rank = static_cast<std::int64_t>(grid.thread_rank());
  const auto lanes = static_cast<std::int64_t>(grid.size());
  const std::int64_t chained = stage.chained_items();
  for (std::int64_t i = rank; i < chained; i += lanes) {
    typename Rounds::Fetched item = stage.fetch(static_cast<std::uint32_t>(i));
    // What is done is done within the loop: lanes of a warp may wait for each other.
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

template <class Rounds>
void Executor::launch_rounds(const char* name, int rounds, std::int64_t most, const Rounds& stage) {
  const auto launch_together = [&](void (*kernel)(int, Rounds), int blocks_each) {
    const auto all = reinterpret_cast<const void*>(kernel);
    const LaunchShape shape = choose_waiting_shape(all, name, most, blocks_each);
    if (shape.blocks == 0) return false;
    const void* arguments[] = {&rounds, &stage};
    check(cudaLaunchCooperativeKernel(all, dim3(static_cast<unsigned>(shape.blocks)),
                                      dim3(static_cast<unsigned>(shape.threads)),
                                      const_cast<void**>(arguments), 0, stream_),
          std::string("launch stage ") + name);
    check_launch(name, shape);
    return true;
  };
  if constexpr (ChainedRounds<Rounds>)
    if (Rounds::chained_beyond_threads || most <= threads_at_once())
      if (launch_together(&run_chain<Rounds>, 2)) return;
  if (launch_together(&run_all_rounds<Rounds>, 1)) return;
  const auto one = reinterpret_cast<const void*>(&run_one_round<Rounds>);
  for (int round = 0; round < rounds; ++round) {
    const LaunchShape shape = choose_shape(one, name, most, true, nullptr);
    run_one_round<Rounds><<<shape.blocks, shape.threads, 0, stream_>>>(round, stage);
    check_launch(name, shape);
  }
}

template <class... Parameters, class... Arguments>
void Executor::run_kernel(const char* name, const KernelNeeds& needs, void (*kernel)(Parameters...),
                          const Arguments&... arguments) {
  if (needs.threads == 0) return;
  begin_stage(name);
  const LaunchShape shape = choose_shape(reinterpret_cast<const void*>(kernel), name, needs.threads,
                                         needs.at_once, needs.shared_bytes);
  const std::size_t shared = needs.shared_bytes != nullptr ? needs.shared_bytes(shape.threads) : 0;
  kernel<<<shape.blocks, shape.threads, shared, stream_>>>(arguments...);
  check_launch(name, shape);
}

#endif

}  // namespace collidoscope

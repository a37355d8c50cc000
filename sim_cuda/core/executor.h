#pragma once
// An Executor runs stages: on a GPU, or on the threads of the CPU, through one interface. It owns the stream
// or the threads, and these parts: the memory (memory_space.h), the record of stages (stage_recorder.h), and
// on a GPU the choice of launch shapes (launch_planner.h). It outlives every buffer and graph made on it.
//
//   executor.run("bounds", body_count, BodyBounds{...});
//
// calls BodyBounds::operator()(int item) for every item, B blocks of T threads sharing them (launch_shape.h).
// A stage's items must not depend on each other: any order and any number at a time gives the same result.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/compute_device.h"
#include "sim_cuda/core/cpu_lanes.h"
#include "sim_cuda/core/executor_options.h"
#include "sim_cuda/core/host_device.h"
#include "sim_cuda/core/item_count.h"
#include "sim_cuda/core/item_kernels.h"
#include "sim_cuda/core/launch_planner.h"
#include "sim_cuda/core/memory_space.h"
#include "sim_cuda/core/parallel_for.h"
#include "sim_cuda/core/round_kernels.h"
#include "sim_cuda/core/stage_clock.h"
#include "sim_cuda/core/stage_recorder.h"
#include "sim_cuda/core/step_graph.h"

#if SIM_CUDA
#include "sim_cuda/core/cuda_check.h"
#endif

namespace collidoscope {

class Executor {
 public:
  /// Throws MachineError if the device asked for is not available, InputError if an option is out of range.
  explicit Executor(const ExecutorOptions& options);
  ~Executor();
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  bool on_device() const { return device_.is_gpu; }
  int gpu() const { return on_device() ? options_.gpu : -1; }
  const std::string& device_name() const { return device_.name; }
  /// The number of CPU cores that would be about as fast.
  double equal_cores() const;
  const ExecutorOptions& options() const { return options_; }
  StageClock& clock() { return stages_.clock(); }
  ThreadTeam& team() { return team_; }

  /// Changes (B, T) for the stages enqueued from now on. Throws MachineError beyond the device's limits.
  void set_shape(LaunchShape shape);

  // Memory of this executor, on the device or the host: see MemorySpace.
  void* allocate(const char* name, std::size_t bytes) { return memory_.allocate(name, bytes); }
  void release(void* memory, std::size_t bytes) { memory_.release(memory, bytes); }
  std::int64_t allocated_bytes() const { return memory_.allocated_bytes(); }
  std::map<std::string, std::int64_t> bytes_by_name() const { return memory_.bytes_by_name(); }
  std::int64_t available_bytes() const { return memory_.available_bytes(); }
  std::int64_t room_bytes() const { return memory_.room_bytes(); }
  std::int64_t dry_run_allocation(const std::function<void()>& reserve) {
    return memory_.dry_run_allocation(reserve);
  }
  std::int64_t dry_run_construction(const std::function<void()>& make) {
    return memory_.dry_run_construction(make);
  }
  bool is_construction_dry_run() const { return memory_.is_construction_dry_run(); }
  bool is_dry_run() const { return memory_.is_dry_run(); }
  void count_dry_run_bytes(std::int64_t bytes) { memory_.count_dry_run_bytes(bytes); }

  // Copies and fills, in the order of the stages. A copy has been done when the function returns; a fill has
  // only been enqueued.
  void copy_to_executor(void* destination, const void* host_source, std::size_t bytes);
  void copy_to_host(void* host_destination, const void* source, std::size_t bytes);
  void fill(void* destination, int byte, std::size_t bytes);
  void synchronize();

  // Cancellation (ExecutorOptions::cancellation). On the CPU, stages throw Cancelled at their start or
  // between chunks. On a GPU, the functions that wait for the device throw it; the device continues its work.

  /// Throws Cancelled if that was requested. For work between stages.
  void throw_if_cancelled();
  /// Something was cancelled and may be incomplete: buffers that outlive a step, too. On a GPU the executor
  /// cannot be used any more.
  bool interrupted() const;
  /// What was incomplete has been computed again.
  void resume() { team_.resume(); }
  /// While an object of this class exists, nothing is cancelled.
  class Uninterrupted {
   public:
    explicit Uninterrupted(Executor& executor) : executor_(executor) { executor_.suspend_cancellation(1); }
    ~Uninterrupted() { executor_.suspend_cancellation(-1); }
    Uninterrupted(const Uninterrupted&) = delete;
    Uninterrupted& operator=(const Uninterrupted&) = delete;

   private:
    Executor& executor_;
  };

  /// For stages with recursive functions: bytes of stack for each thread, in addition to the usual. Not
  /// within a step.
  void reserve_call_stack(std::size_t bytes);

  /// What is enqueued from now on belongs to this stage. `library_launch`: (B, T) does not apply to it,
  /// because a library launches its kernels.
  void begin_stage(const char* name, bool library_launch = false);
  /// On the CPU: the stage ran so many parallel loops. On a GPU the nodes of the graph are counted instead.
  void count_launches(int launches);
  /// Stages that begin from now on belong to this substep (from 0). Only StageCallback receives the number.
  void begin_substep(int substep) { stages_.begin_substep(substep); }

  using StageCallback = StageRecorder::StageCallback;
  /// Calls `work`, and `ended` after each of its stages: see StageRecorder.
  void run_with_stage_callback(const StageCallback& ended, const std::function<void()>& work) {
    stages_.run_with_stage_callback(ended, work);
  }

#if !SIM_CUDA || defined(__CUDACC__)
  /// Runs one stage over all items. Returns when it is done on the CPU, when it is enqueued on a GPU.
  template <class Stage>
  void run(const char* name, const ItemCount& count, const Stage& stage) {
    if (count.max == 0) return;
    begin_stage(name);
    if (!on_device()) return run_on_cpu(count.value(), stage);
#if defined(__CUDACC__)
    launch_stage(planner_, stream_, name, count, stage);
#endif
  }

  /// Runs several rounds of one stage, each over all its items before the next begins (round_kernels.h).
  /// `max_items`: the expected number of items in a round, from which (B, T) is chosen; 0: nothing runs.
  template <ItemRounds Rounds>
  void run_rounds(const char* name, int rounds, std::int64_t max_items, const Rounds& stage) {
    if (max_items == 0) return;
    begin_stage(name);
#if defined(__CUDACC__)
    if (on_device()) return launch_rounds(planner_, stream_, name, rounds, max_items, stage);
#endif
    for (int round = 0; round < rounds; ++round)
      if (const std::int64_t items = stage.items(round); items > 0)
        run_on_cpu(items, OneRound<Rounds>{stage, round});
  }
#endif

#if SIM_CUDA
  cudaStream_t stream() const { return stream_; }
#endif

#if defined(__CUDACC__)
  /// Launches a kernel that is not a stage (item_kernels.h), on a GPU only.
  template <class... Parameters, class... Arguments>
  void run_kernel(const char* name, const KernelNeeds& needs, void (*kernel)(Parameters...),
                  const Arguments&... arguments) {
    if (needs.threads == 0) return;
    begin_stage(name);
    launch_kernel(planner_, stream_, name, needs, kernel, arguments...);
  }
#endif

 private:
  friend class StepGraph;  // reports the begin and the end of a step to stages_

  /// On the CPU, "auto": about how many items a thread takes at a time.
  static constexpr std::int64_t cpu_chunk = 512;
  template <class Stage>
  void run_on_cpu(std::int64_t count, const Stage& stage) {
    run_loop(count, &stage, [](const void* one, std::int64_t first, std::int64_t stride, std::int64_t items) {
      const Stage& s = *static_cast<const Stage*>(one);
      for (std::int64_t k = 0; k < items; ++k) s(static_cast<int>(first + k * stride));
    });
  }
  void run_loop(std::int64_t count, const void* stage, ItemLoop loop);
  /// One more parallel loop of the stage in progress: `lanes` of them share the items; 0: chunks.
  void count_loop(std::int64_t items, std::int64_t lanes);
  void suspend_cancellation(int more);

  ExecutorOptions options_;
  ThreadTeam team_;
  ComputeDevice device_;
  MemorySpace memory_;
  StageRecorder stages_;
  int suspensions_ = 0;  ///< objects of class Uninterrupted
#if SIM_CUDA
  LaunchPlanner planner_;
  cudaStream_t stream_ = nullptr;
#endif
};

}  // namespace collidoscope

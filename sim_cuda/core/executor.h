#pragma once
// An Executor runs stages on a GPU or on CPU threads, through one interface. It owns the stream or the
// threads, the memory (memory_space.h), the stage recorder (stage_recorder.h), and the launch planner of a
// GPU (launch_planner.h). It must outlive all buffers and graphs that use it.
//
//   executor.run("bounds", body_count, BodyBounds{...});
//
// calls BodyBounds::operator()(int item) for every item, distributed over B blocks of T threads
// (launch_shape.h). Precondition: the items of a stage are independent. Any order and any parallelism then
// give the same result.

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
  /// Throws MachineError if the requested device is not available, InputError if an option is out of range.
  explicit Executor(const ExecutorOptions& options);
  ~Executor();
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  bool on_device() const { return device_.is_gpu; }
  int cpu_threads() const { return team_.threads(); }
  const std::string& driver() const { return device_.driver; }
  int gpu() const { return on_device() ? options_.gpu : -1; }
  const std::string& device_name() const { return device_.name; }
  /// Number of CPU cores with about the same throughput; on the CPU, the number of threads used.
  double equal_cores() const;
  const ExecutorOptions& options() const { return options_; }
  StageClock& clock() { return stages_.clock(); }
  ThreadTeam& team() { return team_; }

  /// Sets (B, T) for the stages enqueued afterwards. Throws MachineError if the device does not support it.
  /// `only_if_they_fit`: a kernel that cannot have its shape gets an automatic one.
  void set_shapes(LaunchShape shape, const StageShapes& by_stage, bool only_if_they_fit = false);

  // Memory of this executor, on the device or the host. See MemorySpace.
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

  // Copies and fills, in stream order with the stages. A copy to or from the host is complete on return. A
  // fill is only enqueued.
  void copy_to_executor(void* destination, const void* host_source, std::size_t bytes);
  void copy_to_host(void* host_destination, const void* source, std::size_t bytes);
  /// Both in this executor's memory, or both on the host. Only enqueued on a GPU.
  void copy(void* destination, const void* source, std::size_t bytes);
  void fill(void* destination, int byte, std::size_t bytes);
  void synchronize();

  // Cancellation (ExecutorOptions::cancellation). On the CPU, stages throw Cancelled at their start or
  // between chunks. On a GPU, the functions that wait for the device throw it; the device continues its work.

  /// Throws Cancelled if a cancellation was requested. For host work between stages.
  void throw_if_cancelled();
  /// On a GPU, throws Cancelled if Cancellation::request_between_steps() was called. The executor remains
  /// usable.
  void throw_if_cancelled_between_steps() const;
  /// Whether work was cancelled since the last resume(). Buffers may then be incomplete, including buffers
  /// that outlive a step. On a GPU the executor is no longer usable.
  bool interrupted() const;
  /// Call this after all incomplete data has been recomputed.
  void resume() { team_.resume(); }
  /// Suspends cancellation while an object of this class exists.
  class Uninterrupted {
   public:
    explicit Uninterrupted(Executor& executor) : executor_(executor) { executor_.suspend_cancellation(1); }
    ~Uninterrupted() { executor_.suspend_cancellation(-1); }
    Uninterrupted(const Uninterrupted&) = delete;
    Uninterrupted& operator=(const Uninterrupted&) = delete;

   private:
    Executor& executor_;
  };

  /// Reserves `bytes` of stack per thread, in addition to CUDA's default, for stages with recursive
  /// functions. Must not be called within a step.
  void reserve_call_stack(std::size_t bytes);

  /// Assigns the work enqueued from now on to this stage. `library_launch`: a library launches its kernels,
  /// so that (B, T) does not apply.
  void begin_stage(const char* name, bool library_launch = false);
  /// Runs `work`; its stages appear as one, of the name `stage`.
  template <class Work>
  void run_as_stage(const char* stage, const Work& work) {
    stages_.merge_into(stage);
    work();
    stages_.merge_into(nullptr);
  }
  /// CPU: adds `launches` parallel loops to the count of the stage. No effect on a GPU, where graph nodes are
  /// counted.
  void count_launches(int launches);
  /// Sets the substep index (from 0) that the StageCallback receives. No effect without a callback.
  void begin_substep(int substep) { stages_.begin_substep(substep); }

  using StageCallback = StageRecorder::StageCallback;
  /// Calls `work`, and `ended` after each of its stages. See StageRecorder.
  void run_with_stage_callback(const StageCallback& ended, const std::function<void()>& work) {
    stages_.run_with_stage_callback(ended, work);
  }

#if !SIM_CUDA || defined(__CUDACC__)
  /// Runs one stage over all items. Returns when it is complete on the CPU, and when it is enqueued on a GPU.
  template <class Stage>
  void run(const char* name, const ItemCount& count, const Stage& stage) {
    if (count.max == 0) return;
    begin_stage(name);
    if (!on_device()) return run_on_cpu(count.value(), stage);
#if defined(__CUDACC__)
    launch_stage(planner_, stream_, name, count, stage);
#endif
  }

  /// Runs the rounds of a stage in sequence (round_kernels.h). `max_items`: the expected number of items in a
  /// round, used to choose (B, T). Runs nothing if it is 0.
  template <ItemRounds Rounds>
  void run_rounds(const char* name, int rounds, std::int64_t max_items, const Rounds& stage) {
    if (max_items == 0) return;
    begin_stage(name);
#if defined(__CUDACC__)
    if (on_device()) return launch_rounds(planner_, stream_, name, rounds, max_items, stage);
#endif
    for (int round = 0; round < rounds; ++round) {
      const std::int64_t items = stage.items(round);
      if (items < 0) return;
      if (items == 0) continue;
      if constexpr (MarkedRounds<Rounds>)
        run_marked_on_cpu(items, stage.round(round));
      else
        run_on_cpu(items, OneRound<Rounds>{stage, round});
    }
  }
#endif

#if SIM_CUDA
  cudaStream_t stream() const { return stream_; }
#endif

#if defined(__CUDACC__)
  /// Launches a kernel that is not a stage (item_kernels.h). GPU only.
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

  /// A stage whose items take much longer than usual may have `std::int64_t items_per_chunk() const`.
  template <class Stage>
  void run_on_cpu(std::int64_t count, const Stage& stage) {
    std::int64_t chunk = usual_chunk;
    if constexpr (requires { stage.items_per_chunk(); }) chunk = stage.items_per_chunk();
    const ItemLoop loop = [](const void* one, std::int64_t first, std::int64_t stride, std::int64_t items) {
      const Stage& s = *static_cast<const Stage*>(one);
      for (std::int64_t k = 0; k < items; ++k) s(static_cast<int>(first + k * stride));
    };
    run_loop(count, chunk, &stage, loop);
  }
  template <class Stage>
  void run_marked_on_cpu(std::int64_t count, const Stage& stage) {
    const ItemMarks marks = stage.marks();
    const bool all = marks.by_item == nullptr;
    if (!all) count = list_marked(count, marks);
    if (count > 0) run_on_cpu(count, ListedItems<Stage>{stage, all ? nullptr : marked_.data()});
  }
  /// Lists the marked ones of `count` items in `marked_`, in order. Returns their number.
  std::int64_t list_marked(std::int64_t count, const ItemMarks& marks);
  void run_loop(std::int64_t count, std::int64_t chunk, const void* stage, ItemLoop loop);
  /// Records one parallel loop of the stage in progress. `lanes`: lanes that share the items; 0: chunks.
  void count_loop(std::int64_t items, std::int64_t lanes, std::int64_t chunk);
  void suspend_cancellation(int more);
  void check_shape(LaunchShape shape) const;
  bool cancels_between_steps() const;

  ExecutorOptions options_;
  ThreadTeam team_;
  ComputeDevice device_;
  MemorySpace memory_;
  StageRecorder stages_;
  int suspensions_ = 0;      ///< number of live Uninterrupted objects
  std::vector<int> marked_;  ///< items of the round in progress
#if SIM_CUDA
  LaunchPlanner planner_;
  cudaStream_t stream_ = nullptr;
#endif
};

}  // namespace collidoscope

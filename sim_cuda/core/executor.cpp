#include "sim_cuda/core/executor.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <thread>

#include "sim_cuda/core/cancellation.h"
#include "sim_cuda/core/error.h"

namespace collidoscope {

namespace {

int threads_of(int requested) {
  return requested > 0 ? requested : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace

Executor::Executor(const ExecutorOptions& options)
    : options_(options),
      team_(threads_of(options.cpu_threads)),
      device_(open_device(options)),
      memory_(device_, options)
#if SIM_CUDA
      ,
      planner_(device_, stages_)
#endif
{
  team_.set_cancellation(options.cancellation);
#if SIM_CUDA
  if (on_device()) check(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "create a stream");
#endif
  set_shapes(options.shape, StageShapes(options.stage_shapes));
}

Executor::~Executor() {
#if SIM_CUDA
  if (stream_ != nullptr && !gpu_abandoned()) cudaStreamDestroy(stream_);
#endif
}

void Executor::check_shape(LaunchShape shape) const {
  if (shape.blocks < 0 || shape.threads < 0 || shape.threads > 1024)
    throw InputError("launch shape: " + std::to_string(shape.blocks) + " blocks of " +
                     std::to_string(shape.threads) +
                     " threads; expected 1 or more blocks, 1 to 1024 threads, or 0 for auto");
#if SIM_CUDA
  if (on_device() && (shape.threads > device_.max_threads || shape.blocks > device_.max_blocks))
    throw MachineError("launch shape: " + std::to_string(shape.blocks) + " blocks of " +
                       std::to_string(shape.threads) + " threads; " + device_.name + " supports at most " +
                       std::to_string(device_.max_blocks) + " blocks of " +
                       std::to_string(device_.max_threads));
#endif
}

void Executor::set_shapes(LaunchShape shape, const StageShapes& by_stage, bool only_if_they_fit) {
  check_shape(shape);
  for (const auto& [stage, one] : by_stage) check_shape(one);
#if SIM_CUDA
  planner_.set_shapes(shape, by_stage, only_if_they_fit);
#else
  static_cast<void>(only_if_they_fit);
#endif
  options_.shape = shape;
  options_.stage_shapes = by_stage;
}

void Executor::reserve_call_stack([[maybe_unused]] std::size_t bytes) {
#if SIM_CUDA
  if (!on_device()) return;
  constexpr std::size_t usual = 1024;  // bytes; CUDA's default
  std::size_t now = 0;
  check(cudaDeviceGetLimit(&now, cudaLimitStackSize), "query the call stack size");
  if (now < usual + bytes)
    check(cudaDeviceSetLimit(cudaLimitStackSize, usual + bytes),
          "reserve " + std::to_string(usual + bytes) + " bytes of call stack for each thread");
#endif
}

double Executor::equal_cores() const {
#if SIM_CUDA
  // Measured on an H200 with 132 multiprocessors and 10,000,000 bodies: as fast as 1,300 cores.
  if (on_device()) return 8.0 * device_.multiprocessors;
#endif
  static const int cores = threads_of(0);  // cached, because the C library reads a file for it
  return std::min(team_.threads(), cores);
}

void Executor::copy_to_executor(void* destination, const void* host_source, std::size_t bytes) {
  if (bytes == 0 || is_construction_dry_run()) return;
#if SIM_CUDA
  if (on_device()) {
    if (options_.cancellation != nullptr) synchronize();  // can be cancelled, unlike the wait in a copy
    check(cudaMemcpyAsync(destination, host_source, bytes, cudaMemcpyHostToDevice, stream_),
          "copy " + std::to_string(bytes) + " bytes to the device");
    return synchronize();
  }
#endif
  std::memcpy(destination, host_source, bytes);
}

void Executor::copy_to_host(void* host_destination, const void* source, std::size_t bytes) {
  if (bytes == 0 || is_construction_dry_run()) return;
#if SIM_CUDA
  if (on_device()) {
    if (options_.cancellation != nullptr) synchronize();
    check(cudaMemcpyAsync(host_destination, source, bytes, cudaMemcpyDeviceToHost, stream_),
          "copy " + std::to_string(bytes) + " bytes to the host");
    return synchronize();
  }
#endif
  std::memcpy(host_destination, source, bytes);
}

void Executor::copy(void* destination, const void* source, std::size_t bytes) {
  if (bytes == 0 || is_dry_run()) return;
#if SIM_CUDA
  if (on_device())
    return check(cudaMemcpyAsync(destination, source, bytes, cudaMemcpyDeviceToDevice, stream_),
                 "copy " + std::to_string(bytes) + " bytes");
#endif
  struct Copy {
    std::byte* to;
    const std::byte* from;
  } context{static_cast<std::byte*>(destination), static_cast<const std::byte*>(source)};
  constexpr std::int64_t piece = 1 << 18;
  team_.parallel_for(
      static_cast<std::int64_t>(bytes), piece,
      [](void* c, std::int64_t begin, std::int64_t end) {
        const Copy& k = *static_cast<const Copy*>(c);
        std::memcpy(k.to + begin, k.from + begin, static_cast<std::size_t>(end - begin));
      },
      &context);
}

void Executor::fill(void* destination, int byte, std::size_t bytes) {
  if (bytes == 0 || is_dry_run()) return;
#if SIM_CUDA
  if (on_device())
    return check(cudaMemsetAsync(destination, byte, bytes, stream_),
                 "fill " + std::to_string(bytes) + " bytes");
#endif
  std::memset(destination, byte, bytes);
}

void Executor::synchronize() {
#if SIM_CUDA
  if (!on_device()) return;
  const char* const doing = "complete the queued work";
  Cancellation* const cancellation = suspensions_ > 0 ? nullptr : options_.cancellation;
  if (cancellation == nullptr) return check(cudaStreamSynchronize(stream_), doing);
  // Polls without sleep for the first 5 ms, which is as fast as cudaStreamSynchronize(). Afterwards, each
  // sleep is 1/64 of the time waited so far, at most 5 ms. This limits the added delay to that share.
  using Clock = std::chrono::steady_clock;
  constexpr auto short_work = std::chrono::milliseconds(5), longest_sleep = std::chrono::milliseconds(5);
  const Clock::time_point start = Clock::now();
  for (;;) {
    const cudaError_t status = cudaStreamQuery(stream_);
    if (status != cudaErrorNotReady) return check(status, doing);
    cudaGetLastError();  // clears cudaErrorNotReady, which is not a failure
    const Clock::duration waited = Clock::now() - start;
    if (waited < short_work) continue;
    throw_if_cancelled();
    std::this_thread::sleep_for(std::min<Clock::duration>(waited / 64, longest_sleep));
  }
#endif
}

// ---- cancellation ----

void Executor::throw_if_cancelled() {
  if (!on_device()) return team_.throw_if_cancelled();
  Cancellation* const cancellation = suspensions_ > 0 ? nullptr : options_.cancellation;
  if (cancellation == nullptr || !cancellation->poll() || cancellation->between_steps()) return;
  team_.is_cancelled();  // makes the executor interrupted()
  abandon_gpu();
  throw Cancelled();
}

/// Whether work on a GPU is requested to stop, but not within a step. Runs the poll function.
bool Executor::cancels_between_steps() const {
  Cancellation* const cancellation = suspensions_ > 0 ? nullptr : options_.cancellation;
  return on_device() && cancellation != nullptr && cancellation->poll() && cancellation->between_steps();
}

void Executor::throw_if_cancelled_between_steps() const {
  if (cancels_between_steps()) throw Cancelled();
}

bool Executor::interrupted() const { return team_.stopped(); }

void Executor::suspend_cancellation(int more) {
  suspensions_ += more;
  team_.set_cancellation(suspensions_ > 0 ? nullptr : options_.cancellation);
}

// ---- stages ----

void Executor::begin_stage(const char* name, bool library_launch) {
  if (!on_device()) throw_if_cancelled();
  stages_.begin(name, library_launch);
}

void Executor::count_launches(int launches) {
  if (!on_device()) stages_.count_launches(launches);
}

void Executor::count_loop(std::int64_t items, std::int64_t lanes, std::int64_t chunk) {
  if (!stages_.counting()) return;
  StageLaunch launch;
  launch.items = items;
  launch.chunk = lanes > 0 ? (items + lanes - 1) / lanes : chunk;
  launch.blocks = lanes > 0 ? lanes : (items + chunk - 1) / chunk;
  launch.threads = static_cast<int>(std::clamp<std::int64_t>(launch.blocks, 1, team_.threads()));
  launch.limit =
      launch_limit(launch.blocks, lanes > 0 ? items : launch.blocks, team_.threads(), LaunchLimit::threads);
  stages_.count_loop(launch);
}

std::int64_t Executor::list_marked(std::int64_t count, const ItemMarks& marks) {
  if (static_cast<std::int64_t>(marked_.size()) < count) marked_.resize(static_cast<std::size_t>(count));
  int* next = marked_.data();
  const auto test = [&](std::int64_t item) {
    *next = static_cast<int>(item);
    next += marks.by_item[item] >= marks.least ? 1 : 0;  // without a branch
  };
  // Eight marks at a time: the sum sets the highest bit of each byte with a mark of at least `least`.
  constexpr std::uint64_t ones = 0x0101010101010101u;
  std::int64_t item = 0;
  for (; item + 8 <= count; item += 8) {
    std::uint64_t eight = 0;
    std::memcpy(&eight, marks.by_item + item, sizeof eight);
    if (((eight + ones * (128u - marks.least)) & (ones << 7)) == 0) continue;
    for (int k = 0; k < 8; ++k) test(item + k);
  }
  for (; item < count; ++item) test(item);
  return next - marked_.data();
}

void Executor::run_loop(std::int64_t count, std::int64_t chunk, const void* stage, ItemLoop loop) {
  const LaunchShape shape = shape_of_stage(stages_.stage(), options_.shape, options_.stage_shapes);
  const bool automatic = shape.blocks == 0 || shape.threads == 0;
  if (automatic && options_.lane_order == LaneOrder::contiguous) {
    count_loop(count, 0, chunk);
    return run_in_chunks(team_, count, chunk, loop, stage);
  }
  const std::int64_t requested = automatic ? 64 : static_cast<std::int64_t>(shape.blocks) * shape.threads;
  const std::int64_t lanes = std::min(requested, count);
  count_loop(count, lanes, chunk);
  run_in_lanes(team_, count, lanes, options_.lane_order, chunk, loop, stage);
}

}  // namespace collidoscope

#include "sim_cuda/core/executor.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <fstream>
#include <limits>
#include <new>
#include <thread>
#include <utility>

#include "sim_cuda/core/cancellation.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/host_memory.h"

#if SIM_CUDA
#include <nvtx3/nvToolsExt.h>
#endif

namespace collidoscope {

namespace {

constexpr std::align_val_t host_alignment{64};

/// Work was cancelled while a device was at it. The process is to end: what would wait for the device is
/// left to the operating system.
std::atomic<bool> device_abandoned = false;

int cpu_threads(int asked) {
  return asked > 0 ? asked : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

std::string cpu_name() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.rfind("model name", 0) == 0) {
      const auto colon = line.find(": ");
      if (colon != std::string::npos) return line.substr(colon + 2);
    }
  return "CPU";
}

void push_range([[maybe_unused]] const char* name) {
#if SIM_CUDA
  nvtxRangePushA(name);
#endif
}
void pop_range() {
#if SIM_CUDA
  nvtxRangePop();
#endif
}

/// The largest buffers with their bytes, one that is asked for counted.
std::string largest_of(std::map<std::string, std::int64_t> bytes_by_name, const char* name,
                       std::size_t bytes) {
  bytes_by_name[name] += static_cast<std::int64_t>(bytes);
  std::vector<std::pair<std::int64_t, std::string>> by_size;
  for (const auto& [each, sum] : bytes_by_name) by_size.emplace_back(sum, each);
  std::sort(by_size.rbegin(), by_size.rend());
  constexpr std::size_t most_shown = 4;
  std::string text;
  for (std::size_t k = 0; k < by_size.size() && k < most_shown; ++k)
    text += (k > 0 ? ", '" : "'") + by_size[k].second + "' " + std::to_string(by_size[k].first);
  return text;
}

void give_back(void* memory, [[maybe_unused]] bool on_device) {
#if SIM_CUDA
  // Waits for the device; an error here was, or will be, reported by the next checked call.
  if (on_device) {
    if (!device_abandoned) cudaFree(memory);
    return;
  }
#endif
  ::operator delete(memory, host_alignment);
}

}  // namespace

bool cuda_available(std::string* why) {
#if SIM_CUDA
  int devices = 0;
  const cudaError_t status = cudaGetDeviceCount(&devices);
  if (status == cudaSuccess && devices > 0) return true;
  cudaGetLastError();
  if (why != nullptr)
    *why = status == cudaSuccess ? "CUDA sees no device"
                                 : std::string("CUDA says: ") + cudaGetErrorString(status);
#else
  if (why != nullptr) *why = "this build has no CUDA";
#endif
  return false;
}

Executor::Executor(const ExecutorOptions& options)
    : options_(options), team_(cpu_threads(options.cpu_threads)) {
  team_.set_cancellation(options.cancellation);
  std::string why;
  on_device_ = options.executor != ExecutorKind::cpu && cuda_available(&why);
  if (options.executor == ExecutorKind::cuda && !on_device_)
    throw MachineError("the executor cuda cannot be used: " + why);
  if (!on_device_) {
    device_name_ = cpu_name();
    set_shape(options.shape);
    return;
  }
#if SIM_CUDA
  int devices = 0;
  check(cudaGetDeviceCount(&devices), "count devices");
  if (options.gpu < 0 || options.gpu >= devices)
    throw MachineError("GPU " + std::to_string(options.gpu) + " is not there: this machine has GPUs 0 to " +
                       std::to_string(devices - 1));
  check(cudaSetDevice(options.gpu), "use GPU " + std::to_string(options.gpu));
  cudaDeviceProp properties{};
  check(cudaGetDeviceProperties(&properties, options.gpu), "describe GPU " + std::to_string(options.gpu));
  device_name_ = properties.name;
  max_threads_ = properties.maxThreadsPerBlock;
  max_blocks_ = properties.maxGridSize[0];
  multiprocessors_ = properties.multiProcessorCount;
  limits_ = {properties.maxThreadsPerMultiProcessor, properties.maxBlocksPerMultiProcessor,
             static_cast<int>(properties.sharedMemPerMultiprocessor),
             static_cast<int>(properties.reservedSharedMemPerBlock)};
  check(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "create a stream");
  set_shape(options.shape);
#endif
}

Executor::~Executor() {
#if SIM_CUDA
  if (stream_ != nullptr && !device_abandoned) cudaStreamDestroy(stream_);
#endif
}

void Executor::set_shape(LaunchShape shape) {
  if (shape.blocks < 0 || shape.threads < 0 || shape.threads > 1024)
    throw InputError("a launch of " + std::to_string(shape.blocks) + " blocks of " +
                     std::to_string(shape.threads) +
                     " threads: blocks are 1 or more, threads 1 to 1024, 0 is auto");
#if SIM_CUDA
  if (on_device_ && (shape.threads > max_threads_ || shape.blocks > max_blocks_))
    throw MachineError("asked " + device_name_ + " for " + std::to_string(shape.blocks) + " blocks of " +
                       std::to_string(shape.threads) + " threads; it launches at most " +
                       std::to_string(max_blocks_) + " blocks of " + std::to_string(max_threads_));
#endif
  options_.shape = shape;
}

void Executor::reserve_call_stack([[maybe_unused]] std::size_t bytes) {
#if SIM_CUDA
  if (!on_device_) return;
  constexpr std::size_t usual = 1024;  // what a device gives at first
  std::size_t now = 0;
  check(cudaDeviceGetLimit(&now, cudaLimitStackSize), "ask for the size of a call stack");
  if (now < usual + bytes)
    check(cudaDeviceSetLimit(cudaLimitStackSize, usual + bytes),
          "reserve " + std::to_string(usual + bytes) + " bytes of call stack for each thread");
#endif
}

std::int64_t Executor::available_bytes() const {
  std::int64_t free_bytes = 0;
#if SIM_CUDA
  if (on_device_) {
    std::size_t free = 0, total = 0;
    check(cudaMemGetInfo(&free, &total), "ask for the free memory of the device");
    free_bytes = static_cast<std::int64_t>(free);
  }
#endif
  if (!on_device_) free_bytes = free_host_bytes();
  if (options_.memory_limit > 0) free_bytes = std::min(free_bytes, options_.memory_limit - allocated_bytes_);
  return std::max<std::int64_t>(free_bytes, 0);
}

double Executor::equal_cores() const {
#if SIM_CUDA
  if (on_device_) return 8.0 * multiprocessors_;  // an H200, 132 of them: 1,300 on 10,000,000 bodies
#endif
  static const int cores = cpu_threads(0);  // the system reads a file to say so
  return std::min(team_.threads(), cores);
}

std::int64_t Executor::room_bytes() const {
  const std::int64_t available = available_bytes();
  if (options_.memory_limit > 0 || options_.allow_large) return available;
  // Of the host's buffers, some may not have been written to yet: they still count as available there.
  const std::int64_t taken =
      on_device_ ? allocated_bytes_ : std::min(allocated_bytes_, resident_host_bytes());
  if (available > std::numeric_limits<std::int64_t>::max() - taken) return available;
  return std::max<std::int64_t>((available + taken) / 5 * 4 - allocated_bytes_, 0);
}

std::int64_t Executor::imagine(const std::function<void()>& make) {
  struct UntilTheEnd {  // however it ends
    bool& on;
    ~UntilTheEnd() { on = false; }
  } imagined{imagining_};
  imagining_ = true;
  return rehearse(make);
}

std::int64_t Executor::rehearse(const std::function<void()>& reserve) {
  struct UntilTheEnd {  // of the rehearsal, however it ends
    bool& on;
    ~UntilTheEnd() { on = false; }
  } rehearsal{rehearsing_};
  rehearsing_ = true;
  rehearsed_bytes_ = 0;
  reserve();
  return rehearsed_bytes_;
}

void* Executor::allocate(const char* name, std::size_t bytes) {
  if (bytes == 0) return nullptr;
  void* memory = nullptr;
  const auto refuse = [&](const std::string& answer) {
    throw MachineError(
        "asked " + device_name_ + " for " + std::to_string(bytes) + " bytes for '" + name +
        "', which makes " + std::to_string(allocated_bytes_ + static_cast<std::int64_t>(bytes)) +
        " bytes in all (largest: " + largest_of(bytes_by_name(), name, bytes) + "); it answered: " + answer);
  };
  // A host hands out more than it has and then ends whoever uses it, so that large requests are asked about.
  constexpr std::size_t large = std::size_t{64} << 20;
  if ((options_.memory_limit > 0 || (!on_device_ && bytes >= large)) &&
      static_cast<std::int64_t>(bytes) > available_bytes())
    refuse(std::to_string(available_bytes()) + " bytes are free");
  if (!on_device_) {
    memory = ::operator new(bytes, host_alignment, std::nothrow);
    if (memory == nullptr) refuse("out of memory");
  }
#if SIM_CUDA
  if (on_device_) {
    const cudaError_t status = cudaMalloc(&memory, bytes);
    if (status != cudaSuccess) {
      cudaGetLastError();
      std::size_t free_bytes = 0, total_bytes = 0;
      cudaMemGetInfo(&free_bytes, &total_bytes);
      refuse(std::string(cudaGetErrorString(status)) + ", " + std::to_string(free_bytes) + " of " +
             std::to_string(total_bytes) + " bytes free");
    }
  }
#endif
  try {
    allocations_[memory] = {name, bytes};
  } catch (...) {
    give_back(memory, on_device_);
    throw;
  }
  allocated_bytes_ += static_cast<std::int64_t>(bytes);
  return memory;
}

std::map<std::string, std::int64_t> Executor::bytes_by_name() const {
  std::map<std::string, std::int64_t> bytes;
  for (const auto& [memory, allocation] : allocations_)
    bytes[allocation.name] += static_cast<std::int64_t>(allocation.bytes);
  return bytes;
}

void Executor::release(void* memory, std::size_t bytes) {
  if (memory == nullptr) return;
  allocated_bytes_ -= static_cast<std::int64_t>(bytes);
  allocations_.erase(memory);
  give_back(memory, on_device_);
}

void Executor::copy_to_executor(void* destination, const void* host_source, std::size_t bytes) {
  if (bytes == 0 || imagining_) return;
#if SIM_CUDA
  if (on_device_) {
    if (options_.cancellation != nullptr) synchronize();  // a copy waits, too, but cannot be cancelled
    check(cudaMemcpyAsync(destination, host_source, bytes, cudaMemcpyHostToDevice, stream_),
          "copy " + std::to_string(bytes) + " bytes to the device");
    return synchronize();
  }
#endif
  std::memcpy(destination, host_source, bytes);
}

void Executor::copy_to_host(void* host_destination, const void* source, std::size_t bytes) {
  if (bytes == 0 || imagining_) return;
#if SIM_CUDA
  if (on_device_) {
    if (options_.cancellation != nullptr) synchronize();
    check(cudaMemcpyAsync(host_destination, source, bytes, cudaMemcpyDeviceToHost, stream_),
          "copy " + std::to_string(bytes) + " bytes to the host");
    return synchronize();
  }
#endif
  std::memcpy(host_destination, source, bytes);
}

void Executor::fill(void* destination, int byte, std::size_t bytes) {
  if (bytes == 0 || rehearsing_) return;
#if SIM_CUDA
  if (on_device_)
    return check(cudaMemsetAsync(destination, byte, bytes, stream_),
                 "fill " + std::to_string(bytes) + " bytes");
#endif
  std::memset(destination, byte, bytes);
}

void Executor::synchronize() {
#if SIM_CUDA
  if (!on_device_) return;
  const char* const doing = "finish the work given to it";
  Cancellation* const cancellation = shields_ > 0 ? nullptr : options_.cancellation;
  if (cancellation == nullptr) return check(cudaStreamSynchronize(stream_), doing);
  // Short work is waited for as cudaStreamSynchronize() does it. Of longer work, sleep takes 1/64 at most.
  using Clock = std::chrono::steady_clock;
  constexpr auto short_work = std::chrono::milliseconds(5), longest_sleep = std::chrono::milliseconds(5);
  const Clock::time_point start = Clock::now();
  for (;;) {
    const cudaError_t status = cudaStreamQuery(stream_);
    if (status != cudaErrorNotReady) return check(status, doing);
    cudaGetLastError();  // that it is not ready is no error
    const Clock::duration waited = Clock::now() - start;
    if (waited < short_work) continue;
    heed();
    std::this_thread::sleep_for(std::min<Clock::duration>(waited / 64, longest_sleep));
  }
#endif
}

// ---- cancellation ----

void Executor::heed() {
  if (!on_device_) return team_.heed();
  if (!team_.is_cancelled()) return;
  device_abandoned = true;
  throw Cancelled();
}

bool Executor::interrupted() const { return team_.stopped(); }

void Executor::shield(int more) {
  shields_ += more;
  team_.set_cancellation(shields_ > 0 ? nullptr : options_.cancellation);
}

void Executor::leave_stage() {
  watch_ = nullptr;
  close_stage();
  timing_ = counting_ = false;
}

// ---- stages and their times ----

#if SIM_CUDA
std::size_t Executor::nodes_in_capture() const {
  cudaStreamCaptureStatus status{};
  cudaGraph_t graph = nullptr;
  check(cudaStreamGetCaptureInfo(stream_, &status, nullptr, &graph, nullptr, nullptr, nullptr),
        "describe the recording");
  if (status != cudaStreamCaptureStatusActive) return 0;
  std::size_t nodes = 0;
  check(cudaGraphGetNodes(graph, nullptr, &nodes), "count the nodes of a graph");
  return nodes;
}
#endif

void Executor::begin_stage(const char* name, bool own_shape) {
  if (!on_device_) heed();
  if (stage_ != nullptr && std::strcmp(stage_, name) == 0) {
    if (own_shape) clock_.entry(name).own_shape = true;
    return;
  }
  end_stage();
  StageClock::Entry& entry = clock_.entry(name);
  if (own_shape) entry.own_shape = true;
  stage_ = name;
  stage_entry_ = clock_.index(entry);
  stage_substep_ = substep_;
  push_range(name);
#if SIM_CUDA
  if (recording_ != nullptr) {
    if (recording_->instrumented_) recording_->mark(stage_entry_);
    stage_nodes_ = nodes_in_capture();
  }
#endif
  if (timing_) stage_start_ = std::chrono::steady_clock::now();
}

void Executor::end_stage() {
  const char* ended = stage_;
  close_stage();
  if (watch_ == nullptr || ended == nullptr) return;
  const StageEnded* watch = std::exchange(watch_, nullptr);
  (*watch)(ended, stage_substep_);
  close_stage();
  watch_ = watch;
}

void Executor::run_watched(const StageEnded& ended, const std::function<void()>& work) {
  end_stage();
  substep_ = 0;
  watch_ = &ended;
  struct UntilTheEnd {  // of the work, however it ends
    const StageEnded*& watch;
    ~UntilTheEnd() { watch = nullptr; }
  } watched{watch_};
  work();
  end_stage();
}

void Executor::close_stage() {
  if (stage_ == nullptr) return;
  if (timing_)
    clock_.add(
        stage_entry_,
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - stage_start_).count());
#if SIM_CUDA
  if (recording_ != nullptr && counting_) {
    const int launches = static_cast<int>(nodes_in_capture() - stage_nodes_);
    clock_.entry(stage_).launches += launches;
  }
#endif
  stage_ = nullptr;
  pop_range();
}

void Executor::count_launches(int launches) {
  if (counting_ && !on_device_ && stage_ != nullptr) clock_.at(stage_entry_).launches += launches;
}

void Executor::count_loop(std::int64_t items, std::int64_t lanes) {
  if (!counting_ || stage_ == nullptr) return;
  count_launches(1);
  StageLaunch launch;
  launch.items = items;
  launch.chunk = lanes > 0 ? (items + lanes - 1) / lanes : cpu_chunk;
  launch.blocks = lanes > 0 ? lanes : (items + cpu_chunk - 1) / cpu_chunk;
  launch.threads = static_cast<int>(std::clamp<std::int64_t>(launch.blocks, 1, team_.threads()));
  launch.limit =
      launch_limit(launch.blocks, lanes > 0 ? items : launch.blocks, team_.threads(), LaunchLimit::threads);
  clock_.add_launch(stage_entry_, launch);
}

void Executor::run_loop(std::int64_t count, const void* stage, ItemLoop loop) {
  const bool automatic = options_.shape.blocks == 0 || options_.shape.threads == 0;
  if (automatic && options_.lane_order == LaneOrder::contiguous) {
    count_loop(count, 0);
    return run_in_chunks(team_, count, cpu_chunk, loop, stage);
  }
  const std::int64_t asked =
      automatic ? 64 : static_cast<std::int64_t>(options_.shape.blocks) * options_.shape.threads;
  const std::int64_t lanes = std::min(asked, count);
  count_loop(count, lanes);
  run_in_lanes(team_, count, lanes, options_.lane_order, cpu_chunk, loop, stage);
}

#if SIM_CUDA
const Executor::KernelFit& Executor::kernel_fit(const void* kernel, int threads, const char* name,
                                                SharedBytes shared) {
  const auto known = fits_.find({kernel, threads});
  if (known != fits_.end()) return known->second;
  const std::string doing = std::string("work out the occupancy of stage ") + name;
  cudaFuncAttributes attributes{};
  check(cudaFuncGetAttributes(&attributes, kernel), doing);
  const auto shared_bytes = [&](int block) { return shared != nullptr ? shared(block) : 0; };
  constexpr std::size_t granted = 48 << 10;  // without being asked
  if (const std::size_t most = shared_bytes(max_threads_); most > granted)
    check(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, static_cast<int>(most)),
          doing);
  const auto resident = [&](int block) {
    int blocks = 0;
    check(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, kernel, block, shared_bytes(block)), doing);
    return blocks;
  };
  int best = threads, most = 0;
  for (int block = 128; threads == 0 && block >= 32; block -= 32)
    if (const int at_once = resident(block) * block; at_once > most) {
      most = at_once;
      best = block;
    }
  KernelFit fit{};
  fit.threads = best;
  fit.registers = attributes.numRegs;
  fit.shared_bytes = static_cast<int>(attributes.sharedSizeBytes + shared_bytes(best));
  fit.resident_blocks = resident(best);
  fit.occupancy = static_cast<double>(fit.resident_blocks * 32 * ((best + 31) / 32)) / limits_.threads;
  fit.limit = residency_limit(limits_, best, fit.shared_bytes, fit.resident_blocks);
  return fits_.emplace(std::pair{kernel, threads}, fit).first->second;
}

LaunchShape Executor::choose_shape(const void* kernel, const char* name, std::int64_t items, bool at_once,
                                   SharedBytes shared) {
  const KernelFit& fit = kernel_fit(kernel, options_.shape.threads, name, shared);
  const std::int64_t needed = (items + fit.threads - 1) / fit.threads;
  const std::int64_t resident = std::int64_t{fit.resident_blocks} * multiprocessors_;
  LaunchShape shape{options_.shape.blocks, fit.threads};
  // A thread for each item: the hardware hands blocks out as others end, which evens out queries of unequal
  // length.
  if (shape.blocks == 0) shape.blocks = static_cast<int>(at_once ? std::min(needed, resident) : needed);
  note_shape(items, shape, fit);
  return shape;
}

LaunchShape Executor::choose_waiting_shape(const void* kernel, const char* name, std::int64_t items,
                                           int blocks_each) {
  // A block or two for each multiprocessor, so that all move data, but no more, so that few wait for each
  // other.
  const std::int64_t blocks = std::int64_t{multiprocessors_} * blocks_each,
                     shared = (items + blocks - 1) / blocks;
  const int usual =
      static_cast<int>(std::clamp<std::int64_t>((shared + 31) / 32 * 32, 64, max_threads_ / blocks_each));
  const int threads = options_.shape.threads > 0 ? options_.shape.threads : usual;
  const KernelFit& fit = kernel_fit(kernel, threads, name, nullptr);
  const std::int64_t resident = std::int64_t{fit.resident_blocks} * multiprocessors_;
  LaunchShape shape{options_.shape.blocks, threads};
  if (shape.blocks > resident) return {0, 0};
  if (shape.blocks == 0) shape.blocks = static_cast<int>(std::min((items + threads - 1) / threads, resident));
  note_shape(items, shape, fit);
  return shape;
}

void Executor::note_shape(std::int64_t items, LaunchShape shape, const KernelFit& fit) {
  if (recording_ == nullptr) return;
  const std::int64_t needed = (items + fit.threads - 1) / fit.threads;
  const std::int64_t resident = std::int64_t{fit.resident_blocks} * multiprocessors_;
  clock_.add_launch(stage_entry_, {items, shape.blocks, shape.threads, 0, fit.resident_blocks,
                                   multiprocessors_, fit.registers, fit.shared_bytes, fit.occupancy,
                                   launch_limit(shape.blocks, needed, resident, fit.limit)});
}

void Executor::check_launch(const char* name, LaunchShape shape) {
  check(cudaPeekAtLastError(), std::string("launch stage ") + name + " as " + std::to_string(shape.blocks) +
                                   " blocks of " + std::to_string(shape.threads) + " threads");
}
#endif

StepGraph::StepGraph(Executor& executor, bool instrumented, std::function<void()> enqueue)
    : executor_(executor), instrumented_(instrumented), enqueue_(std::move(enqueue)) {
#if SIM_CUDA
  if (!executor_.on_device()) return;
  executor_.end_stage();
  check(cudaStreamBeginCapture(executor_.stream_, cudaStreamCaptureModeThreadLocal), "record a step");
  executor_.recording_ = this;
  executor_.counting_ = !instrumented;
  executor_.clock_.clear_shapes();
  if (!instrumented) executor_.clock_.clear_launches();
  cudaGraph_t graph = nullptr;
  try {
    enqueue_();
    executor_.end_stage();
    if (instrumented_) mark(0);
  } catch (...) {
    executor_.recording_ = nullptr;
    executor_.stage_ = nullptr;
    cudaStreamEndCapture(executor_.stream_, &graph);
    if (graph != nullptr) cudaGraphDestroy(graph);
    throw;
  }
  executor_.recording_ = nullptr;
  executor_.counting_ = false;
  check(cudaStreamEndCapture(executor_.stream_, &graph), "end the recording of a step");
  const cudaError_t status = cudaGraphInstantiate(&graph_, graph, 0);
  cudaGraphDestroy(graph);
  check(status, "make a graph of a step");
#endif
}

StepGraph::~StepGraph() {
#if SIM_CUDA
  if (device_abandoned) return;
  if (graph_ != nullptr) cudaGraphExecDestroy(graph_);
  for (cudaEvent_t event : events_) cudaEventDestroy(event);
#endif
}

#if SIM_CUDA
void StepGraph::mark(std::size_t entry) {
  cudaEvent_t event = nullptr;
  check(cudaEventCreate(&event), "create an event");
  events_.push_back(event);
  event_entries_.push_back(entry);
  check(cudaEventRecordWithFlags(event, executor_.stream_, cudaEventRecordExternal), "record an event");
}
#endif

void StepGraph::launch() {
#if SIM_CUDA
  if (executor_.on_device()) return check(cudaGraphLaunch(graph_, executor_.stream_), "run a step");
#endif
  executor_.end_stage();
  executor_.clock_.clear_launches();
  executor_.clock_.clear_shapes();
  executor_.counting_ = true;
  executor_.timing_ = instrumented_;
  try {
    enqueue_();
    executor_.end_stage();
  } catch (const Cancelled&) {
    executor_.leave_stage();
    throw;
  }
  executor_.timing_ = executor_.counting_ = false;
}

void StepGraph::collect() {
#if SIM_CUDA
  if (!executor_.on_device()) return;
  for (std::size_t k = 0; k + 1 < events_.size(); ++k) {
    float milliseconds = 0;
    check(cudaEventElapsedTime(&milliseconds, events_[k], events_[k + 1]), "read the time of a stage");
    executor_.clock_.add(event_entries_[k], milliseconds);
  }
#endif
}

}  // namespace collidoscope

#include "sim_cuda/core/elapsed.h"

#include <chrono>

namespace collidoscope {
#if SIM_CUDA
namespace {

/// CUDA event: a time stamp in a stream, on the device's clock.
class DeviceEvent {
 public:
  DeviceEvent() { check(cudaEventCreate(&event_), "create an event"); }
  ~DeviceEvent() { cudaEventDestroy(event_); }
  DeviceEvent(const DeviceEvent&) = delete;
  DeviceEvent& operator=(const DeviceEvent&) = delete;

  void record(cudaStream_t stream) { check(cudaEventRecord(event_, stream), "record an event"); }
  double milliseconds_since(const DeviceEvent& before) const {
    float elapsed = 0;
    check(cudaEventElapsedTime(&elapsed, before.event_, event_), "read the time between two events");
    return static_cast<double>(elapsed);
  }

 private:
  cudaEvent_t event_ = nullptr;
};

}  // namespace
#endif

double milliseconds_of([[maybe_unused]] Executor& executor, const std::function<void()>& work) {
#if SIM_CUDA
  if (executor.on_device()) {
    DeviceEvent begin, end;
    begin.record(executor.stream());
    work();
    end.record(executor.stream());
    executor.synchronize();
    return end.milliseconds_since(begin);
  }
#endif
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace collidoscope

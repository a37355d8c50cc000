#include "sim_cuda/core/elapsed.h"

#include <chrono>

namespace collidoscope {

double milliseconds_of([[maybe_unused]] Executor& executor, const std::function<void()>& work) {
#if SIM_CUDA
  if (executor.on_device()) {
    cudaEvent_t begin = nullptr, end = nullptr;
    check(cudaEventCreate(&begin), "create an event");
    check(cudaEventCreate(&end), "create an event");
    check(cudaEventRecord(begin, executor.stream()), "record an event");
    work();
    check(cudaEventRecord(end, executor.stream()), "record an event");
    executor.synchronize();
    float elapsed = 0;
    check(cudaEventElapsedTime(&elapsed, begin, end), "read the time of a step");
    cudaEventDestroy(begin);
    cudaEventDestroy(end);
    return static_cast<double>(elapsed);
  }
#endif
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace collidoscope

#include "sim_cuda/core/scan.h"

#if defined(__CUDACC__)
#include <cub/device/device_scan.cuh>
#include <cuda/std/functional>
#endif

namespace collidoscope {

std::size_t scan_temporary_bytes([[maybe_unused]] Executor& executor, [[maybe_unused]] std::int64_t count) {
  std::size_t bytes = 0;
#if defined(__CUDACC__)
  if (executor.on_device())
    check(
        cub::DeviceScan::ExclusiveScan(nullptr, bytes, static_cast<const std::uint32_t*>(nullptr),
                                       static_cast<std::uint32_t*>(nullptr), cuda::std::plus<std::uint32_t>{},
                                       std::uint32_t{0}, static_cast<int>(count + 1)),
        "query the workspace size of a scan");
#endif
  return bytes;
}

void exclusive_scan(Executor& executor, const char* stage, std::int64_t count, const std::uint32_t* counts,
                    std::uint32_t* offsets, [[maybe_unused]] void* temporary,
                    [[maybe_unused]] std::size_t temporary_bytes) {
  executor.begin_stage(stage, true);
#if defined(__CUDACC__)
  if (executor.on_device())
    return check(cub::DeviceScan::ExclusiveScan(temporary, temporary_bytes, counts, offsets,
                                                cuda::std::plus<std::uint32_t>{}, std::uint32_t{0},
                                                static_cast<int>(count + 1), executor.stream()),
                 "scan " + std::to_string(count) + " counts");
#endif
  executor.count_launches(1);
  std::uint32_t sum = 0;
  for (std::int64_t i = 0; i < count; ++i) {
    offsets[i] = sum;
    sum += counts[i];
  }
  offsets[count] = sum;
}

}  // namespace collidoscope

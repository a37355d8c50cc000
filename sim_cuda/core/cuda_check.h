#pragma once
// Error check for CUDA calls, in every build. A failure becomes a MachineError that states the requested
// action and the CUDA error.

#if SIM_CUDA

#include <cuda_runtime_api.h>

#include <string>

#include "sim_cuda/core/error.h"

namespace collidoscope {

template <class Action>
inline void check(cudaError_t status, const Action& action) {
  if (status == cudaSuccess) return;
  cudaGetLastError();  // clears the sticky copy; `status` is reported
  throw MachineError("CUDA: cannot " + std::string(action) + ": " + cudaGetErrorString(status) + " (" +
                     cudaGetErrorName(status) + ")");
}

}  // namespace collidoscope

#endif

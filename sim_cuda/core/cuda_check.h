#pragma once
// Every CUDA call goes through check(): in every build, a refusal becomes a MachineError that says what was
// asked of the device and what it answered.

#if SIM_CUDA

#include <cuda_runtime_api.h>

#include <string>

#include "sim_cuda/core/error.h"

namespace collidoscope {

template <class Action>
inline void check(cudaError_t status, const Action& action) {
  if (status == cudaSuccess) return;
  cudaGetLastError();  // the sticky copy; this one is reported
  throw MachineError("CUDA: asked to " + std::string(action) + "; the device answered: " +
                     cudaGetErrorString(status) + " (" + cudaGetErrorName(status) + ")");
}

}  // namespace collidoscope

#endif

#pragma once
// SIM_HD marks a function that is written once and compiled for the CPU and, where nvcc sees it, for the GPU.

#if defined(__CUDACC__)
#define SIM_HD __host__ __device__
#else
#define SIM_HD
#endif

namespace collidoscope {

/// What no thread writes while the stage runs: on a GPU, from the one cache that waiting for others does not
/// empty. For numbers.
template <class Number>
SIM_HD inline Number read_only(const Number* source) {
#if defined(__CUDA_ARCH__)
  return __ldg(source);
#else
  return *source;
#endif
}

}  // namespace collidoscope

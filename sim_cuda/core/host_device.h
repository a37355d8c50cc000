#pragma once
// SIM_HD marks functions that are compiled for the CPU and, under nvcc, also for the GPU.

#if defined(__CUDACC__)
#define SIM_HD __host__ __device__
#else
#define SIM_HD
#endif

namespace collidoscope {

/// Loads a scalar that is constant during the stage. On a GPU it uses the read-only data cache (__ldg), which
/// grid barriers do not invalidate.
template <class Number>
SIM_HD inline Number read_only(const Number* source) {
#if defined(__CUDA_ARCH__)
  return __ldg(source);
#else
  return *source;
#endif
}

}  // namespace collidoscope

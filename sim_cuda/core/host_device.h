#pragma once
// SIM_HD marks a function that is written once and compiled for the CPU and, where nvcc sees it, for the GPU.

#if defined(__CUDACC__)
#define SIM_HD __host__ __device__
#else
#define SIM_HD
#endif

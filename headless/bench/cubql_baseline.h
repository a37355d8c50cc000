#pragma once
// Baseline: pair finding by cuBQL (I. Wald et al., NVIDIA), a GPU library of BVH queries. Uses its Morton
// builder and its box query. Input: boxes on the device. Output: unordered pairs on the device.
// cuBQL is not part of this project. Set CMake's -DCOLLIDOSCOPE_CUBQL=FOLDER to its checkout.

#include <cstdint>
#include <span>
#include <vector>

#include "sim_cuda/core/aabb.h"

namespace collidoscope {

bool has_cubql();

struct BaselineTimes {
  std::vector<float> ms;  ///< one per repeat: build, find all pairs, free
  std::int64_t pairs = 0;
  std::int64_t bytes = 0;  ///< of the tree
};
/// Measures on the current CUDA device. Requires has_cubql(). Throws MachineError after a CUDA error.
BaselineTimes time_cubql(std::span<const Aabb> boxes, int repeats);

}  // namespace collidoscope

#pragma once
// The same work by cuBQL (I. Wald et al., NVIDIA), a library of BVHs for queries on a GPU: its Morton builder
// and its box query, from boxes on the device to the list of pairs on the device, in no order. None of its
// code is here: a build knows it where CMake is given -DCOLLIDOSCOPE_CUBQL=FOLDER, its checkout.

#include <cstdint>
#include <span>
#include <vector>

#include "sim_cuda/core/aabb.h"

namespace collidoscope {

bool has_cubql();

struct BaselineTimes {
  std::vector<float> ms;  ///< of each repeat: build, find all pairs, free
  std::int64_t pairs = 0;
  std::int64_t bytes = 0;  ///< of its tree
};
/// On the current CUDA device; needs has_cubql(). Throws MachineError where CUDA refuses something.
BaselineTimes time_cubql(std::span<const Aabb> boxes, int repeats);

}  // namespace collidoscope

#pragma once
// The device of a world, and what the world takes of it. Plain data.

#include <cstdint>
#include <string>

namespace collidoscope {

struct WorldInfo {
  bool on_gpu = false;
  int gpu = -1;                        ///< CUDA's number of the device, -1 on the CPU
  std::string device_name;             ///< "NVIDIA H200", or the CPU's own name
  int key_bits = 0;                    ///< of the broad phase's Morton keys: 24, 30 or 63; 0: it has none
  std::int64_t allocated_bytes = 0;    ///< in the executor's memory space
  std::int64_t broad_phase_bytes = 0;  ///< of them, those of the broad phase's method alone
};

}  // namespace collidoscope

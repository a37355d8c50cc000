#pragma once
// Device and memory use of a world. Plain data.

#include <cstdint>
#include <string>

namespace collidoscope {

struct WorldInfo {
  bool on_gpu = false;
  int gpu = -1;                      ///< CUDA device number; -1 on the CPU
  std::string device_name;           ///< "NVIDIA H200", or the name of the CPU
  std::string tuned;                 ///< which result of `tune` the automatic shapes are from; empty: of none
  std::string tuned_rejection;       ///< why none is used, if there are any; see TunedChoice
  int key_bits = 0;                  ///< bits of the Morton keys: 24, 30 or 63; 0: no keys
  std::int64_t allocated_bytes = 0;  ///< in the executor's memory space
  std::int64_t broad_phase_bytes = 0;  ///< part of them used by the broad phase method
};

}  // namespace collidoscope

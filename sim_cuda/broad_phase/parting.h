#pragma once
// Where two neighbouring leaves of a tree over sorted keys part: the higher the bit in which their keys
// differ, the nearer the root. Equal keys part by their places.

#include <cstdint>

#include "sim_cuda/core/host_device.h"

namespace collidoscope {

struct WideParting {
  std::uint64_t keys;
  std::uint32_t places;
  SIM_HD friend bool operator<(const WideParting& a, const WideParting& b) {
    return a.keys < b.keys || (a.keys == b.keys && a.places < b.places);
  }
};

/// Of the bits in which keys and places differ; for 30-bit keys both fit in one word.
SIM_HD inline std::uint64_t parting_of(std::uint32_t keys, std::uint32_t places) {
  return std::uint64_t{keys} << 32 | places;
}
SIM_HD inline WideParting parting_of(std::uint64_t keys, std::uint32_t places) { return {keys, places}; }

}  // namespace collidoscope

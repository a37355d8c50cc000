#pragma once
// Two bodies, by their ids. Plain data.

#include <cstdint>

namespace collidoscope {

/// Two ids a < b whose boxes overlap.
struct Pair {
  std::uint32_t a, b;
};

}  // namespace collidoscope

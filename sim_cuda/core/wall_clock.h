#pragma once
// Wall-clock time that has passed.

#include <chrono>

namespace collidoscope {

/// Seconds since `start`.
inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace collidoscope

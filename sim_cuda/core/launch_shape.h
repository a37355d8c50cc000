#pragma once
// (B, T): how many blocks of how many threads share the items of a stage. Plain data; part of the answer to
// "how", never of the answer to "what": the state does not depend on it.

namespace collidoscope {

struct LaunchShape {
  int blocks = 0;   ///< B, 1 to 2^31-1; 0 is "auto": as many as the device runs at once
  int threads = 0;  ///< T, 1 to 1024 per block; 0 is "auto": the occupancy calculator's choice

  friend bool operator==(const LaunchShape&, const LaunchShape&) = default;
};

}  // namespace collidoscope

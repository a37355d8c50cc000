#pragma once
// Launch shape (B, T): a stage's items are distributed over B blocks of T threads. Plain data. The state does
// not depend on it.

namespace collidoscope {

struct LaunchShape {
  int blocks = 0;   ///< B, 1 to 2^31-1; 0: automatic (launch_planner.h)
  int threads = 0;  ///< T, 1 to 1024 per block; 0: automatic, by the occupancy calculator

  friend bool operator==(const LaunchShape&, const LaunchShape&) = default;
};

}  // namespace collidoscope

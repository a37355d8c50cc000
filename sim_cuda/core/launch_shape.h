#pragma once
// Launch shape (B, T): a stage's items are distributed over B blocks of T threads. Plain data. The state does
// not depend on it.

#include <string>
#include <vector>

namespace collidoscope {

struct LaunchShape {
  int blocks = 0;   ///< B, 1 to 2^31-1; 0: automatic (launch_planner.h)
  int threads = 0;  ///< T, 1 to 1024 per block; 0: automatic, by the occupancy calculator

  friend bool operator==(const LaunchShape&, const LaunchShape&) = default;
};

/// Shapes of single stages.
struct StageShape {
  std::string stage;
  LaunchShape shape;
  friend bool operator==(const StageShape&, const StageShape&) = default;
};
using StageShapes = std::vector<StageShape>;
/// The shape of a stage; `stage` may be null.
inline LaunchShape shape_of_stage(const char* stage, LaunchShape shape, const StageShapes& by_stage) {
  for (const StageShape& one : by_stage)
    if (stage != nullptr && one.stage == stage) return one.shape;
  return shape;
}

}  // namespace collidoscope

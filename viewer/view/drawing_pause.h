#pragma once
// Time that a software renderer leaves to the simulation, since both use the same cores.

#include <algorithm>

namespace collidoscope {

/// Seconds to wait after a frame that took `frame_seconds`, if the simulation is slower than requested.
/// `news`: the frame showed a new state or a part of one. Gives about ten frames per second.
inline double drawing_pause(double frame_seconds, bool news) {
  return news ? std::min(2.3 * frame_seconds, 0.07) : 0.085;
}

}  // namespace collidoscope

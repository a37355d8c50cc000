#pragma once
// Restitution: ratio of separation speed to approach speed. A pair takes the larger coefficient of its
// materials, as in Box2D and box3d. Approach speeds below the threshold do not bounce, so that resting
// contacts settle.

#include <cmath>
#include <cstdint>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/host_device.h"

namespace collidoscope {

/// Separation speed at the gap at which a body approaches a static surface, m/s, after an impact at the
/// surface; 0 if the rebound does not reach the gap. `approach`, m/s; `gap`, m; `acceleration`: to the
/// surface, m/s^2.
template <class Real>
SIM_HD Real rebound_speed(Real approach, Real gap, Real acceleration, Real e) {
  const Real lift = 2 * acceleration * gap, squared = e * e * (approach * approach + lift) - lift;
  using std::sqrt;
  return squared > 0 ? sqrt(squared) : Real(0);
}

template <class Real>
struct Restitution {
  const Real* of_material = nullptr;        ///< coefficient by material, 0 to 1
  const std::uint16_t* material = nullptr;  ///< by body; null: all bodies have material 0
  Real threshold = 0;                       ///< m/s, approach speed

  SIM_HD Real of_body(std::uint32_t body) const {
    return of_material[material == nullptr ? 0 : material[body]];
  }
  /// Coefficient of a pair; 0 if `approach` (m/s) is not above the threshold.
  SIM_HD Real between(Real e_a, Real e_b, Real approach) const {
    return approach > threshold ? max_of(e_a, e_b) : Real(0);
  }
  SIM_HD Real of_pair(Pair bodies, Real approach) const {
    return between(of_body(bodies.a), of_body(bodies.b), approach);
  }
};

}  // namespace collidoscope

#pragma once
// How much of an approach speed a contact gives back: the larger coefficient of the two materials (as in
// Box2D and box3d), so that a rubber ball bounces on any floor; nothing below the threshold, or resting
// contacts would never rest.

#include <cstdint>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/host_device.h"

namespace collidoscope {

template <class Real>
struct Restitution {
  const Real* of_material = nullptr;        ///< 0 to 1, by material
  const std::uint16_t* material = nullptr;  ///< by body; null where all bodies are of material 0
  Real threshold = 0;                       ///< m/s, approach speed

  SIM_HD Real of_body(std::uint32_t body) const {
    return of_material[material == nullptr ? 0 : material[body]];
  }
  /// `approach` > 0 in m/s; the result applies where it is above the threshold.
  SIM_HD Real between(Real e_a, Real e_b, Real approach) const {
    return approach > threshold ? max_of(e_a, e_b) : Real(0);
  }
  SIM_HD Real of_pair(Pair bodies, Real approach) const {
    return between(of_body(bodies.a), of_body(bodies.b), approach);
  }
};

}  // namespace collidoscope

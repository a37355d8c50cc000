#pragma once
// User-visible reasons why "auto" enables an effect in a scene, or does not.

#include <string>

#include "sim_cuda/scene/initial_bodies.h"

namespace collidoscope {

struct EffectReason {
  bool required = false;  ///< as in required_effects()
  std::string why;        ///< for example "gravity is 9.81 m/s²", "no medium"
  std::string cannot;     ///< why the effect is not supported at all; empty if it is
};

/// `flag` must be one of effect_names.
EffectReason effect_reason(const Scene& scene, const InitialBodies& bodies, bool Effects::*flag);

}  // namespace collidoscope

#pragma once
// Why an effect is among those that a scene calls for, or is not: a few words, for people.

#include <string>

#include "sim_cuda/scene/initial_bodies.h"

namespace collidoscope {

struct EffectReason {
  bool required = false;  ///< as required_effects() has it
  std::string why;        ///< "gravity is 9.81 m/s²", "no medium"
  std::string cannot;     ///< why it cannot be on whatever calls for it, or empty
};

/// `flag` is one of effect_names.
EffectReason effect_reason(const Scene& scene, const InitialBodies& bodies, bool Effects::*flag);

}  // namespace collidoscope

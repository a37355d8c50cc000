#pragma once
// Which values the colours of bodies span. A free function.

#include "sim_cuda/world.h"
#include "viewer/render/frame_uniforms.h"

namespace collidoscope {

/// `stats`: of the state that is drawn.
ValueRange value_range(const World& world, BodyColor color, const StepStats& stats);

}  // namespace collidoscope

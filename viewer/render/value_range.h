#pragma once
// Which values the colours of bodies span. A free function.

#include "sim_cuda/publish.h"
#include "sim_cuda/step_stats.h"
#include "viewer/render/frame_scene.h"
#include "viewer/render/frame_uniforms.h"

namespace collidoscope {

/// `stats`: of the state that is drawn.
ValueRange value_range(const FrameScene& scene, BodyColor color, const StepStats& stats);

}  // namespace collidoscope

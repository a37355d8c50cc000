#pragma once
// Which values the colours of bodies and boxes span. A free function.

#include "sim_cuda/world.h"
#include "viewer/render/frame_layers.h"
#include "viewer/render/frame_scene.h"
#include "viewer/render/frame_uniforms.h"

namespace collidoscope {

/// `stats`: of the state that is drawn. The world's tree is asked, and measured, only where something is
/// coloured by it.
ValueRange value_range(World& world, const FrameScene& scene, const FrameLayers& layers,
                       const StepStats& stats);

}  // namespace collidoscope

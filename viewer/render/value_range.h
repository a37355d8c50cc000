#pragma once
// Which values the colours of bodies and boxes span, and the scale of error lines. Free functions.

#include <vector>

#include "sim_cuda/world.h"
#include "viewer/render/frame_layers.h"
#include "viewer/render/frame_scene.h"
#include "viewer/render/frame_uniforms.h"

namespace collidoscope {

/// `stats`: of the state that is drawn. The world's tree is asked, and measured, only where something is
/// coloured by it.
ValueRange value_range(World& world, const FrameScene& scene, const FrameLayers& layers,
                       const StepStats& stats);

/// The power of ten, 1 to 1e9, by which lines of errors (m) are longer than the errors. The greater errors
/// are about as long as a body is wide, and the greatest is at most a quarter of the scene.
double automatic_error_scale(const std::vector<float>& errors, double body_size, double scene_size);

}  // namespace collidoscope

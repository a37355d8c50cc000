#pragma once
// Value ranges of the colours of bodies and boxes, and the scale of error vectors. Free functions.

#include <vector>

#include "sim_cuda/world.h"
#include "viewer/render/frame_layers.h"
#include "viewer/render/frame_scene.h"
#include "viewer/render/frame_uniforms.h"

namespace collidoscope {

/// `stats`: those of the drawn state. The tree is measured only if it provides a colour.
ValueRange value_range(World& world, const FrameScene& scene, const FrameLayers& layers,
                       const StepStats& stats);

/// Scale of error vectors (errors in m): a power of ten, 1 to 1e9. Large errors are drawn about as long as a
/// body is wide, and the largest is at most a quarter of the scene.
double automatic_error_scale(const std::vector<float>& errors, double body_size, double scene_size);

}  // namespace collidoscope

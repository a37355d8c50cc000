#pragma once
// Legends of the colours in a picture. Free functions; colours are 0xAABBGGRR.

#include <cstdint>
#include <vector>

#include "sim_cuda/measure/step_stats.h"
#include "sim_cuda/publish/legend.h"
#include "sim_cuda/publish/publish.h"
#include "viewer/render/frame_uniforms.h"

namespace collidoscope {

/// Legend of bodies coloured by `color` over `range`. `stats`: those of the drawn state.
Legend body_legend(BodyColor color, const ValueRange& range, const StepStats& stats);
/// Legend of boxes coloured by a metric. No title for the level: see level_legend().
Legend box_legend(NodeMetric metric, const ValueRange& range);
/// Colours of ascending values, perceptually uniform.
std::vector<std::uint32_t> value_legend();
/// Contact colours from range.max_impulse / 1000 to range.max_impulse, on a logarithmic scale.
std::vector<std::uint32_t> contact_legend();
/// Colours of ghosts and of error vectors.
std::uint32_t ghost_legend();
std::uint32_t error_legend();
/// Colours of marks, indexed by BoxMark.
std::vector<std::uint32_t> mark_legend();
/// Colours of levels 0 to 63 if levels `first` to `last` are shown.
std::vector<std::uint32_t> level_legend(int first, int last);

}  // namespace collidoscope

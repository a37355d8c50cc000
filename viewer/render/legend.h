#pragma once
// The legends of a picture: what its colours mean. Free functions; colours are 0xAABBGGRR.

#include <cstdint>
#include <vector>

#include "sim_cuda/measure/step_stats.h"
#include "sim_cuda/publish/legend.h"
#include "sim_cuda/publish/publish.h"
#include "viewer/render/frame_uniforms.h"

namespace collidoscope {

/// Of bodies coloured by `color` over `range` at the state of `stats`.
Legend body_legend(BodyColor color, const ValueRange& range, const StepStats& stats);
/// Of boxes coloured by a metric other than their level, which level_legend() tells; else without a title.
Legend box_legend(NodeMetric metric, const ValueRange& range);
/// Colours of contacts from range.max_impulse / 1000 to range.max_impulse, in even steps of the logarithm.
std::vector<std::uint32_t> contact_legend();
/// Of ghosts, and of lines that show errors.
std::uint32_t ghost_legend();
std::uint32_t error_legend();
/// Colours of marks, by BoxMark.
std::vector<std::uint32_t> mark_legend();
/// Colours of the levels 0 to 63 where `first` to `last` are shown.
std::vector<std::uint32_t> level_legend(int first, int last);

}  // namespace collidoscope

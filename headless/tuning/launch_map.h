#pragma once
// The picture of a search: ratio of each shape to the reference, as a heat map over B and T.

#include "headless/tuning/tuned_run.h"
#include "ui/heat_map.h"

namespace collidoscope {

/// Colours are logarithmic, from the fastest shape to 1.5 times its time. Bright is fast.
HeatMap launch_map(const TunedRun& run, const LaunchSearch& search);

}  // namespace collidoscope

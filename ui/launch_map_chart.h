#pragma once
// The map of the launch map panel, on logarithmic axes. Free functions, between ImGui::NewFrame() and
// Render().

#include <limits>
#include <string>
#include <vector>

#include "ui/workspace.h"

namespace collidoscope {

/// What the cells show: times of the step, or of one stage.
struct LaunchMapTimes {
  const LaunchMapView::Stage* stage = nullptr;
  std::vector<double> ms;  ///< by cell; NaN: none
  double fastest = std::numeric_limits<double>::quiet_NaN(),
         slowest = std::numeric_limits<double>::quiet_NaN();
};

/// `stage`: empty for the whole step.
LaunchMapTimes launch_map_times(const LaunchMapView& map, const std::string& stage);

/// Draws the cells, contours and marks, and handles pointer and clicks. Precondition: there are cells.
void draw_launch_map(Workspace& workspace, const WorkspaceView& view, const LaunchMapView& map,
                     const LaunchMapTimes& shown);
/// The colour scale. Precondition: a cell was measured.
void draw_launch_map_scale(const LaunchMapView& map, const LaunchMapTimes& shown, bool with_times);

}  // namespace collidoscope

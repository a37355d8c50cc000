#pragma once
// Boxes drawn on top of the picture for the selection in the tree. A free function.

#include <vector>

#include "sim_cuda/measure/body_report.h"
#include "sim_cuda/publish/publish.h"
#include "ui/workspace.h"

namespace collidoscope {

/// Earlier boxes lie on top. A selected body adds its path to the root, or the visits of its query if
/// requested. A selected node adds itself and its children. `body` and `panel` may be null.
std::vector<BoxInstance> tree_marks(const Workspace& workspace, const BodyReport* body,
                                    const TreePanelView* panel);

}  // namespace collidoscope

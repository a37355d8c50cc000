#pragma once
// The boxes that are drawn on top of the picture: what is selected of the tree. A free function.

#include <vector>

#include "sim_cuda/measure/body_report.h"
#include "sim_cuda/publish/publish.h"
#include "ui/workspace.h"

namespace collidoscope {

/// Those that come first lie on top. Of a selected body its path to the root, or, where that is asked for,
/// what its query has visited so far; of a selected node itself and its children. `body`, `panel`: or null.
std::vector<BoxInstance> tree_marks(const Workspace& workspace, const BodyReport* body,
                                    const TreePanelView* panel);

}  // namespace collidoscope

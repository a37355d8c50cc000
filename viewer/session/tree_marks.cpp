#include "viewer/session/tree_marks.h"

#include <algorithm>

namespace collidoscope {
namespace {

template <class Box>  // any type with min and max
BoxInstance mark(const Box& box, std::size_t level, BoxMark kind) {
  BoxInstance record{};
  for (int axis = 0; axis < 3; ++axis) {
    record.min[axis] = box.min[axis];
    record.max[axis] = box.max[axis];
  }
  record.level = static_cast<float>(level);
  record.value = static_cast<float>(kind);
  return record;
}

}  // namespace

std::vector<BoxInstance> tree_marks(const Workspace& workspace, const BodyReport* body,
                                    const TreePanelView* panel) {
  std::vector<BoxInstance> marks;
  const auto add = [&](const NodeReport& node, BoxMark kind) {
    marks.push_back(mark(node, static_cast<std::size_t>(node.level), kind));
  };
  if (panel != nullptr && panel->node) {
    for (std::size_t k = 0; k < panel->children.size(); ++k)
      add(panel->children[k], k % 2 == 0 ? BoxMark::left : BoxMark::right);
    add(*panel->node, BoxMark::node);  // wider lines than its children, so that shared edges show both
  }
  if (body == nullptr) return marks;
  if (panel != nullptr && panel->queried == body->id) {
    const auto shown = std::clamp(static_cast<std::size_t>(std::max(workspace.tree.visit, 1.0)),
                                  std::size_t{0}, panel->visited.size());
    for (std::size_t k = shown; k-- > 0;) {  // the last one is on top
      const auto& [node, met] = panel->visited[k];
      add(node, met ? BoxMark::met : BoxMark::apart);
      if (k + 1 == shown) add(node, BoxMark::current);  // highlight below the visit's own colour
    }
    return marks;
  }
  if (workspace.show_path)
    for (std::size_t i = body->path.size(); i-- > 0;)  // from the root
      marks.push_back(mark(body->path[i], body->path.size() - 1 - i, BoxMark::path));
  return marks;
}

}  // namespace collidoscope

#pragma once
// Levels of the tree that a frame shows. A free function.

#include <algorithm>
#include <utility>

#include "ui/workspace.h"

namespace collidoscope {

/// First and last level of the colour scale: those of the drawn boxes, else those of the selected body's
/// path. `levels`: number of levels of the tree.
inline std::pair<int, int> colored_levels(const FrameLayers& layers, std::size_t levels,
                                          const BodyReport* selected) {
  const int deepest = std::max(static_cast<int>(levels) - 1, 0);
  if (layers.boxes) return {std::min(layers.first_level, deepest), std::min(layers.last_level, deepest)};
  const bool path = selected != nullptr && !selected->path.empty();
  return {0, path ? static_cast<int>(selected->path.size()) - 1 : deepest};
}

}  // namespace collidoscope

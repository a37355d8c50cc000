#pragma once
// Layers of a frame as a workspace has them. Free functions.

#include <algorithm>
#include <utility>

#include "ui/workspace.h"

namespace collidoscope {

/// From anything that has the same members: the renderer's layers, which ui/ may not see.
template <class Layers>
ShownLayers shown_layers(const Layers& layers) {
  ShownLayers shown;
  shown.spheres = layers.spheres;
  shown.boxes = layers.boxes;
  shown.contacts = layers.contacts;
  shown.grid = layers.grid;
  shown.walls = layers.walls;
  shown.joints = layers.joints;
  shown.ghosts = layers.ghosts;
  shown.errors = layers.errors;
  shown.error_scale = layers.error_scale;
  shown.first_level = layers.first_level;
  shown.last_level = layers.last_level;
  shown.color = layers.color;
  shown.box_color = layers.box_color;
  shown.box_low = layers.box_low;
  shown.box_high = layers.box_high;
  return shown;
}

/// First and last level that colours span: those of the boxes that are drawn, else those of the selected
/// body's path. `levels`: of the tree.
inline std::pair<int, int> colored_levels(const ShownLayers& layers, std::size_t levels,
                                          const BodyReport* selected) {
  const int deepest = std::max(static_cast<int>(levels) - 1, 0);
  if (layers.boxes) return {std::min(layers.first_level, deepest), std::min(layers.last_level, deepest)};
  const bool path = selected != nullptr && !selected->path.empty();
  return {0, path ? static_cast<int>(selected->path.size()) - 1 : deepest};
}

}  // namespace collidoscope

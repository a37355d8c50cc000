#pragma once
// Layers of a frame as a workspace has them. A free function.

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

}  // namespace collidoscope

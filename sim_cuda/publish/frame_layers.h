#pragma once
// Visible layers of a frame. Plain data. A frame is a deterministic function of state, camera and layers:
// equal input gives equal bytes. No randomness or clock is used.

#include <limits>

#include "sim_cuda/publish/publish.h"

namespace collidoscope {

struct FrameLayers {
  bool spheres = false;                  ///< all bodies, including mesh bodies
  bool boxes = false;                    ///< boxes of the tree, levels first_level to last_level
  int first_level = 0, last_level = 63;  ///< inclusive, level from the root; clipped to existing levels
  bool contacts = false;
  bool ghosts = false;       ///< bodies of the reference at the same time
  bool errors = false;       ///< lines from bodies to their ghosts
  int error_scale = 0;       ///< magnification of the error lines; 0: automatic
  bool joints = true;        ///< drawn if the scene has joints
  bool grid = true;          ///< floor with a line spacing of a round number of metres
  bool walls = true;         ///< edges of the scene's box
  bool overlay = true;       ///< text: scene, state, counts, stage times, legend
  bool ui = false;           ///< the viewer's panels around the picture, instead of the overlay
  bool tree = false;         ///< with `ui`: unfold the panel of the tree
  bool convergence = false;  ///< with `ui`: unfold the panel of solver convergence
  BodyColor color = BodyColor::speed;
  NodeMetric box_color = NodeMetric::level;
  /// Range of the boxes' metric. Boxes outside are hidden, and the colour map spans the values inside.
  float box_low = 0, box_high = std::numeric_limits<float>::infinity();
  int highlighted_level = -1;  ///< boxes of other levels are drawn faint; -1: none

  bool needs_reference() const { return ghosts || errors || color == BodyColor::error; }
  friend bool operator==(const FrameLayers&, const FrameLayers&) = default;
};

/// Initial layers of the window: bodies, and panels instead of the overlay.
inline FrameLayers window_layers() {
  FrameLayers layers;
  layers.spheres = true;
  layers.overlay = false;
  return layers;
}
/// Returns `asked` without the layers that the window does not have.
inline FrameLayers window_layers(FrameLayers asked) {
  asked.overlay = asked.ui = asked.tree = asked.convergence = false;
  asked.highlighted_level = -1;
  return asked;
}

}  // namespace collidoscope

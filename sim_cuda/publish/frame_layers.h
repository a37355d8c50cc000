#pragma once
// What a frame shows. Plain data: a frame is a function of the state, the camera and these layers, without
// randomness and without a clock, so that the same three give the same bytes.

#include <limits>

#include "sim_cuda/publish/publish.h"

namespace collidoscope {

struct FrameLayers {
  bool spheres = false;                  ///< all bodies, mesh bodies too
  bool boxes = false;                    ///< the hierarchy's AABBs, levels first_level to last_level
  int first_level = 0, last_level = 63;  ///< inclusive, depth from the root; clipped to the levels there are
  bool contacts = false;
  bool ghosts = false;       ///< the bodies as a reference has them at the same time
  bool errors = false;       ///< lines from each body towards its ghost
  int error_scale = 0;       ///< how many times as long as the error; 0: as it suits
  bool joints = true;        ///< where there are any
  bool grid = true;          ///< the floor, with a line every round number of metres
  bool walls = true;         ///< the edges of the scene's box
  bool overlay = true;       ///< text: scene, state, counts, stage times, legend
  bool ui = false;           ///< the viewer's panels around the picture, in the overlay's place
  bool tree = false;         ///< of them the tree's unfolded
  bool convergence = false;  ///< or that of the solver's sweeps
  BodyColor color = BodyColor::speed;
  NodeMetric box_color = NodeMetric::level;
  /// Of the boxes' metric: those outside are not drawn, and the colours span what is there of it.
  float box_low = 0, box_high = std::numeric_limits<float>::infinity();
  int highlighted_level = -1;  ///< boxes of all other levels are faint; -1: none

  bool needs_reference() const { return ghosts || errors || color == BodyColor::error; }
  friend bool operator==(const FrameLayers&, const FrameLayers&) = default;
};

/// Of the window at its start: bodies, and panels in place of the overlay.
inline FrameLayers window_layers() {
  FrameLayers layers;
  layers.spheres = true;
  layers.overlay = false;
  return layers;
}
/// Of `asked` those that the window has, too.
inline FrameLayers window_layers(FrameLayers asked) {
  asked.overlay = asked.ui = asked.tree = asked.convergence = false;
  asked.highlighted_level = -1;
  return asked;
}

}  // namespace collidoscope

#pragma once
// What a frame shows. Plain data: a frame is a function of the state, the camera and these layers, with no
// randomness and no clock, so that the same three give the same bytes.

#include <limits>
#include <string>

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

  friend bool operator==(const FrameLayers&, const FrameLayers&) = default;
};

/// Reads `spheres,bvh:2-5,contacts`: spheres, bvh (all levels), bvh:A, bvh:A-B, contacts, ghosts, errors,
/// errors:A, ui, ui:tree, ui:convergence, grid, walls, joints, overlay, and no-grid, no-walls, no-joints,
/// no-overlay: those four are drawn unless switched off. Throws InputError, one line per fault, each
/// beginning with `where` (the flag's name).
FrameLayers parse_layers(const std::string& text, const std::string& where = "--layers");

/// speed, radius, id, contacts, order, depth, visits, sleep or error. Throws InputError.
BodyColor parse_body_color(const std::string& text, const std::string& where = "--color");
/// level, sah, overlap, empty or visits. Throws InputError.
NodeMetric parse_box_color(const std::string& text, const std::string& where = "--box-color");
/// LOW,HIGH: 0 <= LOW <= HIGH, which may be `inf`. Throws InputError.
void parse_box_range(const std::string& text, FrameLayers& layers, const std::string& where = "--box-range");

}  // namespace collidoscope

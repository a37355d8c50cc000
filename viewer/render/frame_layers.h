#pragma once
// Layers from the text of flags. Free functions.

#include <string>

#include "sim_cuda/publish/frame_layers.h"

namespace collidoscope {

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

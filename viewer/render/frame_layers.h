#pragma once
// Parsers of layer flags. Free functions.

#include <string>

#include "sim_cuda/publish/frame_layers.h"

namespace collidoscope {

/// Parses a list such as `spheres,bvh:2-5,contacts`. Names: spheres, bvh (all levels), bvh:A, bvh:A-B,
/// contacts, ghosts, errors, errors:A, ui, ui:tree, ui:convergence, grid, walls, joints, overlay. Drawn by
/// default and switched off by no-grid, no-walls, no-joints, no-overlay. Throws InputError with one line per
/// fault, each prefixed by `where` (the flag's name).
FrameLayers parse_layers(const std::string& text, const std::string& where = "--layers");

/// Parses speed, radius, id, contacts, order, depth, visits, sleep or error. Throws InputError.
BodyColor parse_body_color(const std::string& text, const std::string& where = "--color");
/// Parses level, sah, overlap, empty or visits. Throws InputError.
NodeMetric parse_box_color(const std::string& text, const std::string& where = "--box-color");
/// Parses LOW,HIGH with 0 <= LOW <= HIGH; HIGH may be `inf`. Throws InputError.
void parse_box_range(const std::string& text, FrameLayers& layers, const std::string& where = "--box-range");

}  // namespace collidoscope

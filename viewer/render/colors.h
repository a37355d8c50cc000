#pragma once
// Colours of pictures, shared by shaders and legends. sRGB, 0 to 1.

#include <array>
#include <cstdint>

#include "sim_cuda/publish/publish.h"

namespace collidoscope {

struct Rgb {
  float r = 0, g = 0, b = 0;
};

/// 256 colours in ascending order of value, perceptually uniform.
const std::array<Rgb, 256>& color_map();
/// 256 colours for boxes, distinct from those of bodies.
const std::array<Rgb, 256>& heat_map();
/// Colour of a tree level if levels `first` to `last` are shown, from dark to light.
Rgb level_color(int level, int first, int last);

/// Style of a box on top of the picture: colour, and half width of the lines in pixels. Paths use
/// level_color().
struct MarkStyle {
  Rgb color;
  float half_width;
};
MarkStyle mark_style(BoxMark mark);

/// Colour of a contact for `strength` 0 (weak) to 1, interpolated between three colours. Contacts without
/// recorded impulse have 0.5.
Rgb contact_color(double strength);

/// Colours of ghosts and of error vectors.
inline constexpr Rgb ghost_color{0.84f, 0.94f, 1.00f}, error_color{1.00f, 0.30f, 0.62f};

/// Title and unit of a legend.
struct ColorMeaning {
  const char* title;
  const char* unit;
};
ColorMeaning color_meaning(BodyColor color);
ColorMeaning color_meaning(NodeMetric metric);

}  // namespace collidoscope

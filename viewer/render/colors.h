#pragma once
// The colours of pictures, for shaders and legends alike. sRGB, 0 to 1.

#include <array>
#include <cstdint>

#include "sim_cuda/publish/publish.h"

namespace collidoscope {

struct Rgb {
  float r = 0, g = 0, b = 0;
};

/// 256 colours from least to greatest value, even to the eye.
const std::array<Rgb, 256>& color_map();
/// The same for boxes, told apart from bodies.
const std::array<Rgb, 256>& heat_map();
/// The colour of a level of the hierarchy where `first` to `last` are shown, from dark to light.
Rgb level_color(int level, int first, int last);

/// Of a box that is drawn on top (a path has level_color()), and pixels to each side of its lines.
struct MarkStyle {
  Rgb color;
  float half_width;
};
MarkStyle mark_style(BoxMark mark);

/// The colour of a contact's mark: `strength` 0 (weak) to 1; between three colours, of which 0.5 is the one
/// of contacts whose impulse is not known.
Rgb contact_color(double strength);

/// Of where a reference has the bodies, and of the lines that lead there.
inline constexpr Rgb ghost_color{0.84f, 0.94f, 1.00f}, error_color{1.00f, 0.30f, 0.62f};

/// What the colour of a body or a box means: the title and unit of the legend.
struct ColorMeaning {
  const char* title;
  const char* unit;
};
ColorMeaning color_meaning(BodyColor color);
ColorMeaning color_meaning(NodeMetric metric);

}  // namespace collidoscope

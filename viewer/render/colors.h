#pragma once
// The colours of pictures, for shaders and legends alike. sRGB, 0 to 1.

#include <array>
#include <cstdint>

#include "sim_cuda/publish.h"

namespace collidoscope {

struct Rgb {
  float r = 0, g = 0, b = 0;
};

/// 256 colours from least to greatest value, even to the eye.
const std::array<Rgb, 256>& color_map();
/// The colour of a level of the hierarchy; neighbours are far apart, eight repeat.
Rgb level_color(int level);

/// The colour of a contact's mark: `strength` 0 (weak) to 1; between three colours, of which 0.5 is the one
/// of contacts whose impulse is not known.
Rgb contact_color(double strength);

/// What a body's colour means: the title and unit of the legend.
struct ColorMeaning {
  const char* title;
  const char* unit;
};
ColorMeaning color_meaning(BodyColor color);

}  // namespace collidoscope

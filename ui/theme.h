#pragma once
// Colours and spacing of panels. Sets ImGui's style; stateless.

#include "ui/workspace.h"

namespace collidoscope {

/// `font_size` in pixels; spacing is proportional to it.
void apply_theme(Theme theme, float font_size);

}  // namespace collidoscope

#pragma once
// Colours and spacing of panels. Sets ImGui's style; keeps nothing.

#include "ui/workspace.h"

namespace collidoscope {

/// `font_size`: pixels; spacing goes with it.
void apply_theme(Theme theme, float font_size);

}  // namespace collidoscope

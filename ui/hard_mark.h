#pragma once
// The marks of trials: told apart by shape, and by colour. Free functions, between ImGui::NewFrame() and
// Render().

#include <cstdint>

#include "ui/hard_cases_facts.h"

struct ImVec2;

namespace collidoscope {

/// 0xAABBGGRR, legible on the theme's background.
std::uint32_t hard_mark_color(HardMark mark, bool light);

/// A tick, a triangle, a cross, a dash; a ring where nothing is known yet, which fills as a trial runs.
/// `size`: pixels of the font; `progress`: 0 to 1.
void draw_hard_mark(const ImVec2& middle, float size, HardMark mark, double progress, bool light);

}  // namespace collidoscope

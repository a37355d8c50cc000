#pragma once
// The marks of test runs: told apart by shape, and by colour. Free functions, between ImGui::NewFrame() and
// Render().

#include <cstdint>

#include "ui/hard_cases_view.h"

struct ImVec2;

namespace collidoscope {

/// 0xAABBGGRR, legible on the theme's background.
std::uint32_t test_status_color(TestStatus status, bool light);

/// A tick, a triangle, a cross, a dash; a ring where nothing is known yet, which fills as a test run runs.
/// `size`: pixels of the font; `progress`: 0 to 1.
void draw_test_status(const ImVec2& middle, float size, TestStatus status, double progress, bool light);

}  // namespace collidoscope

#pragma once
// Marks of test runs, distinguished by shape and colour. Free functions, between ImGui::NewFrame() and
// Render().

#include <cstdint>

#include "ui/hard_cases_view.h"

struct ImVec2;

namespace collidoscope {

/// 0xAABBGGRR, legible on the theme's background.
std::uint32_t test_status_color(TestStatus status, bool light);

/// A tick, a triangle, a cross or a dash; a ring without a result, which fills during the test run. `size`:
/// font size in pixels; `progress`: 0 to 1.
void draw_test_status(const ImVec2& middle, float size, TestStatus status, double progress, bool light);

}  // namespace collidoscope

#include "ui/test_status.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace collidoscope {

std::uint32_t test_status_color(TestStatus status, bool light) {
  switch (status) {
    case TestStatus::passed:
      return light ? IM_COL32(30, 125, 62, 255) : IM_COL32(104, 202, 128, 255);
    case TestStatus::expected_failure:
      return light ? IM_COL32(186, 112, 0, 255) : IM_COL32(245, 190, 80, 255);
    case TestStatus::failed:
      return light ? IM_COL32(200, 32, 36, 255) : IM_COL32(255, 104, 94, 255);
    case TestStatus::waiting:
    case TestStatus::running:
      return ImGui::GetColorU32(ImGuiCol_CheckMark);
    case TestStatus::not_run:
    case TestStatus::not_applicable:
      break;
  }
  return ImGui::GetColorU32(ImGuiCol_TextDisabled, 0.75f);
}

void draw_test_status(const ImVec2& middle, float size, TestStatus status, double progress, bool light) {
  ImDrawList* const list = ImGui::GetWindowDrawList();
  const ImU32 color = test_status_color(status, light);
  const float r = 0.32f * size, thick = std::max(0.13f * size, 1.2f);
  const auto at = [&](float x, float y) { return ImVec2(middle.x + x * r, middle.y + y * r); };
  switch (status) {
    case TestStatus::not_run:
      list->AddCircle(middle, 0.6f * r, color, 0, std::max(0.07f * size, 1.0f));
      break;
    case TestStatus::waiting:
      list->AddCircle(middle, 0.8f * r, color, 0, std::max(0.07f * size, 1.0f));
      break;
    case TestStatus::running: {
      list->AddCircle(middle, r, color, 0, std::max(0.07f * size, 1.0f));
      constexpr float turn = 2 * std::numbers::pi_v<float>;
      const float done = static_cast<float>(std::clamp(progress, 0.0, 1.0));
      list->PathLineTo(middle);
      list->PathArcTo(middle, 0.75f * r, -0.25f * turn, (done - 0.25f) * turn);
      list->PathFillConvex(color);
      break;
    }
    case TestStatus::passed: {
      const ImVec2 tick[] = {at(-1, 0.1f), at(-0.3f, 0.8f), at(1.05f, -0.85f)};
      list->AddPolyline(tick, 3, color, 0, 1.15f * thick);
      break;
    }
    case TestStatus::expected_failure:
      list->AddTriangleFilled(at(0, -1.05f), at(1.2f, 0.95f), at(-1.2f, 0.95f), color);
      break;
    case TestStatus::failed:
      list->AddLine(at(-0.9f, -0.9f), at(0.9f, 0.9f), color, 1.5f * thick);
      list->AddLine(at(-0.9f, 0.9f), at(0.9f, -0.9f), color, 1.5f * thick);
      break;
    case TestStatus::not_applicable:
      list->AddLine(at(-0.8f, 0), at(0.8f, 0), color, thick);
      break;
  }
}

}  // namespace collidoscope

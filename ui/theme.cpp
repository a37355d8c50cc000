#include "ui/theme.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace collidoscope {
namespace {

void dark_colors(ImVec4* colors) {
  ImGui::StyleColorsDark();
  colors[ImGuiCol_WindowBg] = {0.085f, 0.095f, 0.115f, 1};
  colors[ImGuiCol_PopupBg] = {0.11f, 0.12f, 0.145f, 0.98f};
  colors[ImGuiCol_Border] = {0.20f, 0.22f, 0.26f, 1};
  colors[ImGuiCol_Text] = {0.90f, 0.91f, 0.93f, 1};
  colors[ImGuiCol_TextDisabled] = {0.56f, 0.59f, 0.65f, 1};
  colors[ImGuiCol_FrameBg] = {0.15f, 0.165f, 0.20f, 1};
  colors[ImGuiCol_FrameBgHovered] = {0.20f, 0.22f, 0.27f, 1};
  colors[ImGuiCol_FrameBgActive] = {0.23f, 0.27f, 0.34f, 1};
  colors[ImGuiCol_Header] = {0.125f, 0.14f, 0.17f, 1};
  colors[ImGuiCol_Button] = {0.18f, 0.20f, 0.245f, 1};
}

void light_colors(ImVec4* colors) {
  ImGui::StyleColorsLight();
  colors[ImGuiCol_WindowBg] = {0.955f, 0.96f, 0.97f, 1};
  colors[ImGuiCol_PopupBg] = {0.99f, 0.99f, 1.0f, 0.98f};
  colors[ImGuiCol_Border] = {0.80f, 0.82f, 0.85f, 1};
  colors[ImGuiCol_Text] = {0.11f, 0.12f, 0.15f, 1};
  colors[ImGuiCol_TextDisabled] = {0.40f, 0.43f, 0.48f, 1};
  colors[ImGuiCol_FrameBg] = {0.87f, 0.885f, 0.91f, 1};
  colors[ImGuiCol_FrameBgHovered] = {0.82f, 0.84f, 0.88f, 1};
  colors[ImGuiCol_FrameBgActive] = {0.75f, 0.80f, 0.88f, 1};
  colors[ImGuiCol_Header] = {0.90f, 0.91f, 0.93f, 1};
  colors[ImGuiCol_Button] = {0.84f, 0.86f, 0.89f, 1};
}

}  // namespace

void apply_theme(Theme theme, float font_size) {
  ImGuiStyle& style = ImGui::GetStyle();
  style = ImGuiStyle();
  const bool dark = theme == Theme::dark;
  (dark ? dark_colors : light_colors)(style.Colors);
  const ImVec4 accent = dark ? ImVec4(0.31f, 0.62f, 0.93f, 1) : ImVec4(0.10f, 0.43f, 0.80f, 1);
  const auto faded = [&](float alpha) { return ImVec4(accent.x, accent.y, accent.z, alpha); };
  style.Colors[ImGuiCol_HeaderHovered] = faded(0.25f);
  style.Colors[ImGuiCol_HeaderActive] = faded(0.35f);
  style.Colors[ImGuiCol_ButtonHovered] = faded(0.45f);
  style.Colors[ImGuiCol_ButtonActive] = faded(0.7f);
  style.Colors[ImGuiCol_SliderGrab] = faded(0.85f);
  style.Colors[ImGuiCol_SliderGrabActive] = accent;
  style.Colors[ImGuiCol_CheckMark] = accent;
  // Whole pixels: ImGui rounds window sizes, and a fraction of a pixel too much makes them scroll.
  const auto pixels = [&](float at_14) { return std::round(at_14 * font_size / 14); };
  style.WindowPadding = {pixels(10), pixels(6)};
  style.FramePadding = {pixels(6), std::max(pixels(2.5f), 1.0f)};
  style.ItemSpacing = {pixels(6), pixels(4)};
  style.ItemInnerSpacing = {pixels(5), pixels(4)};
  style.CellPadding = {pixels(4), std::max(pixels(1.5f), 1.0f)};
  style.ScrollbarSize = pixels(10);
  style.GrabMinSize = pixels(9);
  style.WindowRounding = 0;
  style.WindowBorderSize = 1;
  style.FrameRounding = pixels(3);
  style.GrabRounding = style.PopupRounding = style.ScrollbarRounding = style.FrameRounding;
}

}  // namespace collidoscope

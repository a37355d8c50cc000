// Tests the workspace: layout of panels, colours of stages, and a frame interrupted by an error.

#include "ui/workspace.h"

#include <gtest/gtest.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sim_cuda/run/history.h"
#include "tests/gl_fixture.h"
#include "ui/panels.h"
#include "ui/theme.h"
#include "ui/widgets.h"
#include "viewer/render/gui_pass.h"
#include "viewer/render/window_frame.h"

namespace collidoscope {
namespace {

TEST(Workspace, ThePictureKeepsItsShareOfTheWidth) {
  for (const auto& [width, height] :
       {std::pair{1280, 720}, {1440, 900}, {1920, 1080}, {1000, 700}, {640, 480}})
    for (const float scale : {0.6f, 1.0f, 1.3f, 2.0f, 3.0f}) {
      const float font = workspace_font_size(width, height, scale);
      const ScreenRect scene =
          scene_view_rect(Workspace{}, static_cast<float>(width), static_cast<float>(height), font);
      EXPECT_GE(scene.width, 0.4f * static_cast<float>(width) - 1) << width << ' ' << scale;
      EXPECT_GE(scene.height, 0.5f * static_cast<float>(height)) << width << ' ' << scale;
    }
  // The text can grow at each of these sizes, and more with a folded column. It never becomes smaller than
  // the default.
  PanelVisibility one_column;
  one_column.right = false;
  for (const auto& [width, height] : {std::pair{1280, 720}, {1440, 900}, {1920, 1080}}) {
    const float usual = workspace_font_size(width, height, 1),
                largest = workspace_font_size(width, height, 3);
    EXPECT_GE(largest, 1.2f * usual);
    EXPECT_GE(workspace_font_size(width, height, 3, 1, one_column), 1.5f * largest);
  }
  EXPECT_EQ(workspace_font_size(640, 480, 3), workspace_font_size(640, 480, 1));
}

TEST(Workspace, TheSizeOfTextIsChangedWithinWhatActs) {
  Workspace workspace;
  workspace.largest_font_scale = 1.24f;
  for (int k = 0; k < 10; ++k) workspace.scale_font(1.1f);
  EXPECT_FLOAT_EQ(workspace.font_scale, 1.24f);
  workspace.scale_font(1 / 1.1f);
  EXPECT_LT(workspace.font_scale, 1.2f) << "one step back acts at once";
  workspace.font_scale = 3;  // as set in a larger window
  workspace.scale_font(1 / 1.1f);
  EXPECT_LT(workspace.font_scale, 1.2f);
}

/// Oklab (B. Ottosson 2020): distances correspond to perceived differences.
struct Lab {
  double l, a, b;
};
Lab lab(std::uint32_t color) {
  const auto linear = [](std::uint32_t byte) {
    const double c = byte / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  };
  const double r = linear(color & 255), g = linear(color >> 8 & 255), b = linear(color >> 16 & 255);
  const double l = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const double m = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const double s = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}
double distance(std::uint32_t x, std::uint32_t y) {
  const Lab a = lab(x), b = lab(y);
  return std::sqrt((a.l - b.l) * (a.l - b.l) + (a.a - b.a) * (a.a - b.a) + (a.b - b.b) * (a.b - b.b));
}

TEST(StageColor, StagesAreToldApart) {
  for (const bool light : {false, true})
    for (std::size_t a = 1; a < 20; ++a) {
      EXPECT_GT(distance(stage_color(a, light), stage_color(a - 1, light)), 0.12)
          << light << a << ": neighbours";
      for (std::size_t b = 0; b < a; ++b)
        EXPECT_GT(distance(stage_color(a, light), stage_color(b, light)), 0.05)
            << light << ' ' << a << ' ' << b;
    }
}

// An error between any two calls: open ImGui scopes are closed, the report is drawn, and the next frame
// works.
TEST(Workspace, AHalfDrawnFrameIsEnded) {
  test_context();
  constexpr int width = 640, height = 480;
  GuiPass gui(13);
  WindowFrame frame(width, height);
  Workspace workspace;
  workspace.scene_view = {0, 0, 640, 480};
  workspace.errors = {"something failed"};
  const auto pixels = [&] {
    int red = 0;
    const Image image = frame.read();
    for (std::size_t at = 0; at + 3 < image.rgba.size(); at += 4)
      red += image.rgba[at] > 100 && image.rgba[at + 1] < 60 && image.rgba[at + 2] < 60;
    return red;
  };
  for (int round = 0; round < 3; ++round) {
    gui.begin(width, height);
    apply_theme(Theme::dark, 13);
    try {
      ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1, 0, 1, 1));
      ImGui::Begin("outer");
      ImGui::PushID(3);
      ImGui::PushStyleVar(ImGuiStyleVar_Alpha, 0.5f);
      ImGui::BeginGroup();
      ImGui::BeginDisabled();
      if (ImGui::BeginTable("table", 3)) {
        ImGui::TableNextColumn();
        ImGui::Begin("inner");
        throw std::runtime_error("here");
      }
    } catch (const std::runtime_error&) {
      end_unfinished_panels(workspace);
    }
    gui.end(frame.target());
  }
  EXPECT_GT(pixels(), 2000) << "the report";
  gui.begin(width, height);
  ImGui::Begin("outer");
  ImGui::TextUnformatted("as ever");
  ImGui::End();
  gui.end(frame.target());
}

TEST(Workspace, AHeldStepKeyLeavesNoBacklog) {
  Workspace workspace;
  workspace.request_step();
  for (int k = 0; k < 100; ++k) workspace.request_step(/*held=*/true);
  EXPECT_EQ(workspace.step_requests, 1);
  EXPECT_FALSE(workspace.playing);
  workspace.request_step();
  EXPECT_EQ(workspace.step_requests, 2) << "each press is a step";
  workspace.play_or_pause();
  EXPECT_EQ(workspace.step_requests, 0);
  EXPECT_TRUE(workspace.playing);
}

TEST(Workspace, ComponentsKeepSmallMotionAndHaveNoNegativeZero) {
  EXPECT_EQ(component_text(12.3456), "   12.346");
  EXPECT_EQ(component_text(-0.25), "   -0.250");
  EXPECT_EQ(component_text(-0.0), "    0.000");
  EXPECT_EQ(component_text(-4.2e-5), "-4.20e-05");
  EXPECT_EQ(component_text(0.0123), " 1.23e-02");
  EXPECT_EQ(component_text(1234567.0), " 1.23e+06");
}

TEST(Workspace, TheRowBelowNSaysWhatTheBodiesAre) {
  WorkspaceView view;
  view.active_settings.generator.count = 60;
  EXPECT_EQ(bodies_text(view), "");
  view.other_bodies = 3;
  EXPECT_EQ(bodies_text(view), "60 generated + 3 others = 63");
  view.removed_bodies = 2;
  EXPECT_EQ(bodies_text(view), "60 generated - 2 removed + 3 others = 61");
}

TEST(Workspace, TheHintStaysWithinTheView) {
  test_context();
  GuiPass gui(13);
  WindowFrame frame(640, 480);
  Workspace workspace;
  WorkspaceView view;
  History history(8);
  view.history = &history;
  gui.begin(640, 480);
  draw_workspace(workspace, view);
  const ScreenRect at = workspace.scene_view;
  const ImDrawList& list = *ImGui::GetBackgroundDrawList();
  ASSERT_GT(list.VtxBuffer.Size, 0);
  for (const ImDrawVert& vertex : list.VtxBuffer) {
    ASSERT_GE(vertex.pos.x, at.x);
    ASSERT_LE(vertex.pos.x, at.x + at.width);
  }
  gui.end(frame.target());
}

// With a long name, "edited" and the button have a row of their own.
TEST(Workspace, EditedIsNotCoveredByTheChanges) {
  test_context();
  GuiPass gui(13);
  WindowFrame frame(640, 480);
  Workspace workspace;
  WorkspaceView view;
  view.edited = true;
  view.changes = 7;
  for (const char* scene : {"Box", "Box Collider, again", "a scene whose name is as long as the panel is"}) {
    view.scene = scene;
    gui.begin(640, 480);
    workspace.widgets.clear();
    ImGui::SetNextWindowSize({250, 400});
    ImGui::Begin("controls");
    draw_run_panel(workspace, view);
    ImGui::End();
    gui.end(frame.target());
    const auto find = [&](const char* name) {
      return std::ranges::find(workspace.widgets, name, [](const auto& one) { return one.first; });
    };
    const auto edited = find("run.edited"), changes = find("run.changes");
    ASSERT_NE(edited, workspace.widgets.end()) << scene;
    ASSERT_NE(changes, workspace.widgets.end()) << scene;
    EXPECT_LE(edited->second.x + edited->second.width, changes->second.x) << scene;
  }
}

}  // namespace
}  // namespace collidoscope

// Tests the accuracy panel: its picture, and clicks and drags in its diagram.

#include <gtest/gtest.h>
#include <imgui.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <ranges>

#include "sim_cuda/accuracy/record.h"
#include "tests/gl_fixture.h"
#include "tests/golden.h"
#include "tests/single_panel.h"
#include "ui/panels.h"
#include "ui/theme.h"

namespace collidoscope {
namespace {

/// A recorded study: a hundred spheres of the Box Collider.
AccuracyView stored_study() {
  const std::string file = golden_file<"accuracy_study.json">().string();
  std::ifstream stream(file);
  const AccuracyRecord record = parse_record({std::istreambuf_iterator<char>(stream), {}}, file);
  AccuracyView panel_view;
  panel_view.points = record.points;
  mark_front(panel_view.points);
  panel_view.reference = record.reference;
  panel_view.executor = record.executor;
  panel_view.done = 1;
  panel_view.seconds = record.reference.seconds;
  for (const AccuracyPoint& point : panel_view.points)
    if (point.name == "1/30 s, 4 substeps" && point.series_name == "soft_step f32")
      panel_view.now = point.setting;
  return panel_view;
}

/// The accuracy panel with this study.
struct AccuracyPanel : SinglePanel {
  AccuracyPanel() : SinglePanel(draw_accuracy_panel, 338, 470) {
    workspace.visible_panels.accuracy = true;
    allow(0.1);
    view.accuracy = &panel_view;
  }
  void allow(double tolerance) {
    workspace.accuracy.tolerance = tolerance;
    panel_view.cheapest = cheapest_below(panel_view.points, tolerance);
  }
  ImVec2 place_of(std::size_t point) const {
    for (const AccuracyPlace& place : workspace.accuracy.places)
      if (place.point == point) return {place.x, place.y};
    ADD_FAILURE() << "no point " << point;
    return {-1, -1};
  }
  ImVec2 line() const {
    return workspace.accuracy.line ? ImVec2{workspace.accuracy.line->x, workspace.accuracy.line->y}
                                   : ImVec2{-1, -1};
  }
  AccuracyView panel_view = stored_study();
};

TEST(PanelPicture, Accuracy) {
  test_context();
  {
    AccuracyPanel dark;
    EXPECT_TRUE(looks_like_golden<"accuracy_dark">(dark.picture()));
  }
  AccuracyPanel light;
  light.workspace.theme = Theme::light;
  light.picture();
  light.pointer = light.place_of(*light.panel_view.cheapest);
  EXPECT_TRUE(looks_like_golden<"accuracy_light">(light.picture()));
}

TEST(PanelPicture, APointOfTheDiagramIsASetting) {
  test_context();
  AccuracyPanel panel;
  panel.picture();
  const std::vector<AccuracyPoint>& points = panel.panel_view.points;
  const auto slowest = std::ranges::max_element(
      points, {}, [](const AccuracyPoint& point) { return point.on_front ? point.ms.median : 0; });
  const auto fine = static_cast<std::size_t>(slowest - points.begin());
  const AccuracySetting& setting = panel.panel_view.points[fine].setting;
  panel.mouse(panel.place_of(fine), false);
  EXPECT_NE(panel.workspace.settings.physics.time_step, setting.time_step)
      << "the pointer alone changes nothing";
  panel.mouse(panel.pointer, true);
  panel.mouse(panel.pointer, false);
  const Settings& request = panel.workspace.settings;
  EXPECT_EQ(request.physics.time_step, setting.time_step);
  EXPECT_EQ(request.physics.substeps, setting.substeps);
  EXPECT_EQ(request.physics.iterations, setting.iterations);
  EXPECT_EQ(request.physics.solver, setting.solver);
  EXPECT_EQ(request.physics.integrator, setting.integrator);
  EXPECT_EQ(request.physics.rotation_update, setting.rotation_update);
  EXPECT_EQ(request.physics.precision, setting.precision);
  ASSERT_TRUE(request.physics.effects);
  EXPECT_EQ(request.physics.effects->continuous_collision, setting.continuous_collision);
}

TEST(PanelPicture, TheErrorThatIsAllowedIsALineToDrag) {
  test_context();
  AccuracyPanel panel;
  panel.picture();
  const ImVec2 line = panel.line();
  panel.mouse(line, false);
  panel.mouse(line, true);
  panel.mouse({line.x - 100, line.y + 40}, true);
  const double dragged = panel.workspace.accuracy.tolerance;
  EXPECT_LT(dragged, 0.05) << "less is below";
  panel.mouse({line.x, line.y + 40}, false);
  panel.mouse(line, false);
  EXPECT_EQ(panel.workspace.accuracy.tolerance, dragged) << "let go, it stays";
  // A click beside the line and all points has no effect.
  panel.mouse({line.x - 4, line.y - 30}, true);
  panel.mouse({line.x - 4, line.y - 60}, true);
  panel.mouse({line.x - 4, line.y - 60}, false);
  EXPECT_EQ(panel.workspace.accuracy.tolerance, dragged);
  // The line stops at a tenth of the smallest error.
  panel.allow(dragged);
  panel.picture();
  panel.mouse(panel.line(), true);
  for (int k = 0; k < 100; ++k) panel.mouse({line.x, 5000}, true);
  double least = 1;
  for (const AccuracyPoint& p : panel.panel_view.points)
    if (p.error > 0 && p.has_cost()) least = std::min(least, p.error);
  EXPECT_NEAR(panel.workspace.accuracy.tolerance, 0.1 * least, 1e-9 * least);
  panel.mouse({-1, -1}, false);
}

}  // namespace
}  // namespace collidoscope

// Tests the panel of hard cases: its picture, and clicks on cases and marks.

#include <gtest/gtest.h>
#include <imgui.h>

#include <array>

#include "tests/gl_fixture.h"
#include "tests/golden.h"
#include "tests/single_panel.h"
#include "ui/panels.h"
#include "ui/theme.h"

namespace collidoscope {
namespace {

/// Cases and results of every kind.
HardCasesView hard_cases() {
  HardCasesView panel_view;
  panel_view.executor = "the CPU";
  panel_view.scene_before = "Box Collider";
  using enum TestStatus;
  const auto add = [&](const char* name, const char* group, std::array<TestStatus, 6> marks) {
    HardCaseView& one = panel_view.cases.emplace_back();
    one.name = name;
    one.what = "a sphere of 1 t lies on one of 1 kg for ten seconds";
    one.group = group;
    for (std::size_t k = 0; k < marks.size(); ++k) {
      TestRunView& test_run = one.test_runs.emplace_back();
      test_run.solver = static_cast<Solver>(k / 2);
      test_run.precision = k % 2 == 0 ? Precision::f32 : Precision::f64;
      test_run.status = marks[k];
      test_run.progress = 0.4;
      test_run.steps = 300;
    }
  };
  add("heavy_on_light_1e3", "mass ratios", {failed, expected_failure, passed, passed, passed, passed});
  add("light_on_heavy_1e6", "mass ratios", {passed, passed, passed, passed, passed, passed});
  add("stack_10", "stacks", {expected_failure, expected_failure, passed, passed, passed, passed});
  add("stack_50", "stacks", {expected_failure, expected_failure, passed, passed, passed, failed});
  add("stack_100_of_growing_spheres", "stacks",
      {expected_failure, expected_failure, passed, passed, running, waiting});
  add("coincident_centres", "overlap", {waiting, waiting, waiting, waiting, waiting, waiting});
  add("hundreds_in_one_point", "overlap", {waiting, waiting, waiting, waiting, waiting, waiting});
  add("joint_loop", "joints", {not_applicable, not_applicable, not_run, not_run, not_run, not_run});
  add("radius_zero", "bad input", {passed, passed, passed, passed, passed, passed});
  panel_view.cases.back().test_runs.resize(1);
  panel_view.cases.back().refused = true;
  TestRunView& failing = panel_view.cases[0].test_runs[0];
  failing.assertions = {{"no body that is not finite", "0", true, 300, std::nullopt},
                        {"penetration at most 0.01 m, states 60 to 300", "0.0123 m", false, 130, 1}};
  failing.failed_state = 130;
  failing.body = 1;
  TestRunView& limit = panel_view.cases[0].test_runs[1];
  limit.why = "the paper's impulses have no memory: what is light sinks in";
  limit.failure = "penetration at most 0.01 m, states 60 to 300: 0.0151 m at state 170, body 1";
  panel_view.shown = 0;
  panel_view.shown_test_run = 0;
  panel_view.current_task = "stack_100_of_growing_spheres, jacobi_split f32";
  return panel_view;
}

struct HardCasesPanel : SinglePanel {
  explicit HardCasesPanel(Theme theme) : SinglePanel(draw_hard_cases_panel, 338, 450) {
    workspace.theme = theme;
    workspace.visible_panels.hard_cases = true;
    workspace.hard_cases.selected = "heavy_on_light_1e3";
    view.hard_cases = &panel_view;
    view.with_times = false;
  }
  ImVec2 middle(const std::string& name) const {
    for (const auto& [widget, rect] : workspace.widgets)
      if (widget == name) return {rect.x + 0.5f * rect.width, rect.y + 0.5f * rect.height};
    ADD_FAILURE() << "no widget " << name;
    return {-1, -1};
  }
  void click(const std::string& name) {
    const ImVec2 at = middle(name);
    mouse(at, false);
    mouse(at, true);
    mouse(at, false);
  }
  HardCasesView panel_view = hard_cases();
};

TEST(PanelPicture, HardCases) {
  test_context();
  {
    HardCasesPanel dark(Theme::dark);
    EXPECT_TRUE(looks_like_golden<"hard_cases_dark">(dark.picture()));
  }
  HardCasesPanel light(Theme::light);
  light.picture();
  light.pointer = light.middle("hard_cases.mark.heavy_on_light_1e3.impulse f32");
  EXPECT_TRUE(looks_like_golden<"hard_cases_light">(light.picture()));
}

TEST(PanelPicture, ACaseAndEachOfItsMarksCanBeOpened) {
  test_context();
  HardCasesPanel panel(Theme::dark);
  panel.picture();
  HardCasesRequests& requests = panel.workspace.hard_cases;
  panel.click("hard_cases.case.stack_10");
  EXPECT_EQ(requests.selected, "stack_10");
  ASSERT_TRUE(requests.open);
  EXPECT_EQ(requests.open->which, 2u);
  EXPECT_FALSE(requests.open->test_run);
  panel.click("hard_cases.mark.stack_50.jacobi_split f64");
  EXPECT_EQ(requests.selected, "stack_50");
  EXPECT_EQ(requests.open->which, 3u);
  EXPECT_EQ(requests.open->test_run, 5u);
  // A case that cannot be opened is selected.
  requests.open.reset();
  panel.click("hard_cases.case.radius_zero");
  EXPECT_EQ(requests.selected, "radius_zero");
  panel.click("hard_cases.mark.radius_zero");
  panel.click("hard_cases.mark.joint_loop.impulse f32");
  EXPECT_FALSE(requests.open);
  panel.click("hard_cases.run");
  EXPECT_TRUE(requests.run_selected);
  panel.click("hard_cases.run_all");
  EXPECT_TRUE(requests.stop) << "something runs";
  EXPECT_FALSE(requests.run_all);
  panel.panel_view.current_task.clear();
  panel.click("hard_cases.run_all");
  EXPECT_TRUE(requests.run_all);
  panel.click("hard_cases.back");
  EXPECT_TRUE(requests.back);
}

}  // namespace
}  // namespace collidoscope

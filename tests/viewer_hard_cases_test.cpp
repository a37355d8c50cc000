// Tests the list of hard cases in the window, by real events. Results appear during the run, and a click
// opens a case or its failing state.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/hard_case_folder.h"
#include "tests/viewer_fixture.h"

namespace collidoscope {
namespace {

TEST_F(Viewer, RunsHardCasesAndOpensThemWhereTheyFailed) {
  HardCaseFolder folder;
  WindowDriver window({"two_spheres_head_on", "--size", "1280x900", "--cases", folder.path()});
  const auto cases = [&](const char* name) { return window.frame()["hard_cases"][name]; };
  const auto mark = [&](const char* name, const char* test_run) { return cases("marks")[name][test_run]; };
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] >= 3; }));
  EXPECT_TRUE(window.frame()["hard_cases"].is_null()) << "folded, nothing is read";
  const std::string scene = window.frame()["scene"];
  window.type_into("settings.restitution.value", "0.5");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["edited"] == true && f["changes"] == 1; }));
  window.click("panel.timing");  // folded, to make room
  ASSERT_TRUE(window.wait_for([](const Json& f) { return !f["widgets"].contains("timing.csv"); }));
  window.next_frame();
  window.click("panel.hard_cases");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["hard_cases"].is_object(); }));
  EXPECT_EQ(cases("counts")["not run"], 31);

  // One case, then all cases, while the scene plays.
  window.click("hard_cases.case.flies");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["scene"] == "flies"; }));
  EXPECT_EQ(cases("selected"), "flies");
  EXPECT_EQ(cases("shown"), "flies");
  EXPECT_EQ(window.frame()["playing"], true) << "as it was";
  window.click("hard_cases.run");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["hard_cases"]["counts"]["passed"] == 6; }));
  EXPECT_EQ(cases("counts")["not run"], 25);
  window.click("hard_cases.run_all");
  ASSERT_TRUE(window.wait_for([](const Json& f) {
    return f["hard_cases"]["counts"]["not run"] == 0 && f["hard_cases"]["doing"] == "";
  }));
  EXPECT_EQ(mark("falls", "soft_step f32"), "failed");
  EXPECT_EQ(mark("limited", "impulse f64"), "declared limit");
  EXPECT_EQ(mark("rubs", "impulse f32"), "not applicable");
  EXPECT_EQ(mark("wrong", "soft_step f32"), "passed");

  // The failing state: paused, with its setting, and the body selected.
  window.click("hard_cases.mark.falls.jacobi_split f64");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["scene"] == "falls" && f["playing"] == false; }));
  EXPECT_EQ(window.frame()["step"], 4);
  EXPECT_EQ(window.frame()["selection"], 1);
  EXPECT_EQ(window.frame()["solver"], "jacobi_split");
  EXPECT_EQ(window.frame()["precision"], "f64");
  EXPECT_THAT(window.frame()["last_notice"].get<std::string>(), testing::HasSubstr("position"));
  // The run continues from there. A case opened now stays paused.
  window.move(640, 300);
  window.key("s");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] == 5; }));
  window.click("hard_cases.case.turned");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["scene"] == "turned"; }));
  EXPECT_EQ(window.frame()["step"], 0);
  EXPECT_EQ(window.frame()["playing"], false);
  EXPECT_TRUE(window.frame()["selection"].is_null());
  window.move(640, 300);
  for (int k = 0; k < 3; ++k) window.key("s");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] == 3; }));
  EXPECT_EQ(window.frame()["time_step"], 0.05) << "its changes are made";
  window.key("r");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] == 0; }));
  window.next_frame();
  EXPECT_EQ(window.frame()["time_step"], 0.1) << "it begins with its own settings";
  EXPECT_EQ(window.frame()["edited"], false);

  window.click("hard_cases.back");
  ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["scene"] == scene; }));
  EXPECT_GE(window.frame()["step"], 3) << "where it was left";
  EXPECT_EQ(window.frame()["edited"], true);
  EXPECT_EQ(window.frame()["changes"], 1) << "with its record";
  EXPECT_EQ(cases("before"), "");
  EXPECT_TRUE(cases("shown").is_null());
  EXPECT_FALSE(window.sees("hard_cases.back"));
  EXPECT_EQ(close(window), "");
}

}  // namespace
}  // namespace collidoscope

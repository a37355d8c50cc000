// Tests effects, thrown bodies and removed bodies in the window, by real events. The run is replayed from the
// file that the window writes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/run_program.h"
#include "tests/viewer_fixture.h"

namespace collidoscope {
namespace {

TEST_F(Viewer, EscapeStopsAMeasurementWithinItsStep) {
#ifdef WITH_SANITIZER  // steps take about ten times as long
  const char* const bodies = "2000";
#else
  const char* const bodies = "10000";
#endif
  WindowDriver window({"box_collider", "--variant", "scaled", "--bodies", bodies, "--friction", "0.3",
                       "--steps", "2", "--size", "1280x800"});
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["playing"] == false && f["step"] == 2; }, 60));
  window.click("panel.effects");
  window.click("effects.measure");
  const auto measures = [](const Json& f) {
    return f["measuring_effects"] == true &&
           std::ranges::any_of(f["effects"], [](const Json& effect) { return effect.contains("cost"); });
  };
  ASSERT_TRUE(window.wait_for(measures, 60)) << window.frame();
  window.move(640, 20);
  window.key("Escape");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["measuring_effects"] == false; }));
  EXPECT_EQ(window.frame()["last_notice"], "measurement stopped");
  EXPECT_TRUE(window.frame()["error"].is_null());
  window.key("s");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] == 3; }, 60)) << "the run continues";
  window.click("effects.measure");
  ASSERT_TRUE(window.wait_for(measures, 60)) << "it can begin again";
  EXPECT_EQ(close(window), "");
}

TEST_F(Viewer, SwitchesEffectsMeasuresThemAndWritesItAllDown) {
  WindowDriver window({"box_collider", "--bodies", "300", "--steps", "5", "--size", "1280x800"});
  const auto effect = [&](const char* name) { return window.frame()["effects"][name]; };
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["playing"] == false && f["step"] == 5; }));
  window.click("panel.effects");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["effects"].contains("gravity"); }));
  EXPECT_EQ(effect("gravity")["on"], true);
  EXPECT_EQ(effect("drag")["called_for"], false);

  // Effects that the scene does not require are greyed: no widget, and a click has no effect.
  const Json seen = window.frame()["widgets"];
  EXPECT_FALSE(seen.contains("effects.drag"));
  const Json gravity = seen["effects.gravity"], guards = seen["effects.guards"];
  const int row = gravity[3].get<int>();
  for (int y = gravity[1].get<int>() + 2 * row; y < guards[1].get<int>(); y += row)
    window.click_at(gravity[0].get<int>() + row / 2, y);
  window.next_frame();
  EXPECT_EQ(effect("drag")["on"], false);
  EXPECT_EQ(window.frame()["changes"], 0);

  const std::string before = window.frame()["state_hash"];
  window.click("effects.measure");
  ASSERT_TRUE(window.wait_for([](const Json& f) {
    return f["effects"]["gravity"].contains("cost") && f["measuring_effects"] == false;
  }));
  EXPECT_EQ(effect("gravity")["cost"]["pairs"], 24);
  EXPECT_EQ(effect("gravity")["cost"]["lack"], "");
  EXPECT_FALSE(effect("drag").contains("cost"));
  EXPECT_EQ(window.frame()["state_hash"], before) << "the run was not touched";
  window.click("effects.measure");

  window.click("effects.gravity");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["effects"]["gravity"]["on"] == false; }));
  EXPECT_EQ(window.frame()["edited"], true);
  window.move(640, 20);
  window.key("s");
  window.key("s");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] == 7; }));
  window.click("effects.auto");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["effects"]["gravity"]["on"] == true; }));

  // Substeps and iterations: typed, by the slider, and reset by "auto". The residuals are drawn.
  EXPECT_EQ(window.frame()["substeps"], "auto");
  window.type_into("settings.substeps", "2");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["substeps"] == 2; }));
  window.click("panel.timing");  // folded, to make room
  window.click("panel.convergence");
  const Json slider = window.frame()["widgets"]["settings.iterations.slider"];
  const int x = slider[0].get<int>(), y = slider[1].get<int>() + slider[3].get<int>() / 2;
  window.drag(x + 5, y, x + slider[2].get<int>() / 2, y);
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["iterations"] > 1 && f["iterations"] < 32; }));
  EXPECT_EQ(window.frame()["changes"], 2) << "a drag is one change";
  window.move(640, 20);
  window.key("s");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] == 8; }));
  EXPECT_TRUE(window.wait_for([](const Json& f) { return f["widgets"].contains("convergence.plot"); }))
      << "recorded with the next step: " << window.frame();
  window.click("panel.convergence");
  EXPECT_TRUE(window.wait_for([](const Json& f) { return !f["widgets"].contains("convergence.plot"); }));
  window.click("settings.substeps.auto");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["substeps"] == "auto"; }));

  window.click("settings.integrator");
  window.click("settings.integrator.velocity_verlet");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["integrator"] == "velocity_verlet"; }));
  EXPECT_FALSE(window.frame()["widgets"].contains("settings.rotation_update")) << "nothing turns";

  // A ball is thrown, then a body is removed.
  window.move(640, 20);
  window.key("b");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["bodies"] == 301; }));
  window.key("s");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] == 9; }));
  for (int k = 0; k < 12 && window.frame()["selection"].is_null(); ++k)
    window.click_at(560 + 14 * k, 420 - 6 * k);
  ASSERT_FALSE(window.frame()["selection"].is_null());
  window.key("Delete");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["bodies"] == 300; })) << window.frame().dump();
  EXPECT_TRUE(window.frame()["selection"].is_null());
  for (int k = 0; k < 4; ++k) window.key("s");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] == 13; }));
  EXPECT_EQ(window.frame()["changes"], 5);

  window.click("run.changes");
  ASSERT_TRUE(window.wait_for([](const Json& f) {
    return f["last_notice"].get<std::string>().starts_with("wrote captures/changes_");
  }));
  const std::string hash = window.frame()["state_hash"];
  const std::string notice = window.frame()["last_notice"];
  const std::string file = window.file(notice.substr(std::string("wrote ").size()));
  const Outcome again =
      run_program(program_folder() / "collidoscope-headless",
                  {"run", "box_collider", "--bodies", "300", "--changes", file, "--json", "-"});
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(Json::parse(again.out)["state_hash"], hash);
  EXPECT_EQ(Json::parse(again.out)["steps"], 13);
  EXPECT_EQ(close(window), "");
}

}  // namespace
}  // namespace collidoscope

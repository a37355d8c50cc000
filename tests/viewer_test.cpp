// Tests the viewer through its window, by real mouse and key events.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/run_program.h"
#include "tests/viewer_fixture.h"

namespace collidoscope {
namespace {

TEST(ViewerCommandLine, SpeaksBeforeItNeedsAWindow) {
  const std::filesystem::path program = program_folder() / "collidoscope";
  if (!std::filesystem::exists(program)) GTEST_SKIP() << "the viewer was not built";
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  const Outcome help = run_program(program, {"--help"});
  EXPECT_EQ(help.status, 0) << help.err;
  EXPECT_THAT(help.out, testing::HasSubstr("--automation FILE"));
  const Outcome wrong = run_program(program, {"--nope", "--json", "x", "one", "two"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, testing::HasSubstr("--nope: unknown flag"));
  EXPECT_THAT(wrong.err, testing::HasSubstr("--json: unknown flag"));
  const Outcome blind = run_program(program, {"--bodies", "10"});
  EXPECT_EQ(blind.status, 3);
  EXPECT_THAT(blind.err, testing::HasSubstr("no window"));
}

TEST_F(Viewer, ObeysMouseAndKeys) {
  WindowDriver window({"box_collider", "--bodies", "300", "--size", "1280x720"});
  const auto value = [&](const char* name) { return window.frame()[name]; };

  // The viewer starts playing; then pause and single steps.
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["playing"] == true && f["step"] >= 2; }));
  window.click_at(640, 300);
  window.key("space");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["playing"] == false; }));
  const std::int64_t paused_at = value("step");
  window.next_frame();
  EXPECT_EQ(value("step"), paused_at);
  window.click("run.step");
  window.key("s");
  ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["step"] == paused_at + 2; }));
  EXPECT_EQ(value("state_hash"), expected_hash(paused_at + 2, 300));
  window.key("Escape");

  // At state 0, where bodies touch: a slow machine pauses at a later state, in which none may touch.
  const Json timeline = window.frame()["widgets"]["run.timeline"];
  const int left = timeline[0].get<int>(), right = left + timeline[2].get<int>(),
            middle = timeline[1].get<int>() + timeline[3].get<int>() / 2;
  window.drag(right - 6, middle, left + 2, middle);
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] == 0; }));

  // Each layer changes the picture and the frame data.
  window.move(640, 20);  // no tooltip on the picture
  const Image plain = picture(window);
  for (const char* layer : {"boxes", "contacts", "spheres", "grid", "walls"}) {
    const bool was = window.frame()["layers"][layer];
    window.click(std::string("layers.") + layer);
    ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["layers"][layer] == !was; })) << layer;
    window.move(640, 20);
    const Image other = picture(window);
    EXPECT_GT(difference(plain, other, window.frame()), 0.0005) << layer;
    const std::string name = layer;
    EXPECT_TRUE(name != "boxes" || value("drawn")["boxes"] > 20);
    EXPECT_TRUE(name != "contacts" || value("drawn")["contacts"] > 0);
    EXPECT_TRUE(name != "spheres" || value("drawn")["spheres"] == 0);
    window.click(std::string("layers.") + layer);
    ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["layers"][layer] == was; })) << layer;
  }
  window.move(640, 20);
  EXPECT_LT(difference(plain, picture(window), window.frame()), 0.0005) << "all as before";
  window.drag(left + 6, middle, right - 2, middle);
  ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["step"] == paused_at + 2; }));

  // (B, T), typed and by the slider, does not change the state.
  window.type_into("settings.blocks", "7");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["blocks"] == 7; }));
  const Json slider = window.frame()["widgets"]["settings.threads.slider"];
  const int x = slider[0].get<int>(), y = slider[1].get<int>() + slider[3].get<int>() / 2,
            w = slider[2].get<int>();
  window.drag(x + 5, y, x + w / 2, y);
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["threads"] > 1 && f["threads"] < 1024; }));
  window.move(640, 20);
  for (int k = 0; k < 3; ++k) window.key("s");
  ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["step"] == paused_at + 5; }));
  EXPECT_EQ(value("state_hash"), expected_hash(paused_at + 5, 300));
  EXPECT_EQ(value("edited"), false);

  // The camera: orbit, zoom, pan, axis view and orthographic projection.
  const auto camera = [&](int i) {
    return window.frame()["camera"][static_cast<std::size_t>(i)].get<double>();
  };
  const double azimuth = camera(3), distance = camera(5), target = camera(0);
  window.drag(640, 300, 740, 330);
  EXPECT_GT(std::abs(camera(3) - azimuth), 0.05);
  window.hands({"mousemove", "640", "250", "click", "4"});
  window.next_frame();
  EXPECT_LT(camera(5), 0.95 * distance);
  window.drag(640, 300, 720, 300, 3);
  EXPECT_GT(std::abs(camera(0) - target), 0.5);
  window.key("7");
  EXPECT_NEAR(camera(4), 1.5708, 1e-3);
  window.key("5");
  EXPECT_EQ(value("orthographic"), true);
  window.key("5");
  window.key("1");
  window.key("f");
  EXPECT_NEAR(camera(4), 0, 1e-9);
  EXPECT_TRUE(value("selection").is_null());

  // A click selects a body. The inspector opens, and is closed.
  for (int k = 0; k < 12 && window.frame()["selection"].is_null(); ++k)
    window.click_at(560 + 14 * k, 420 - 6 * k);
  ASSERT_FALSE(value("selection").is_null());
  EXPECT_TRUE(window.sees("inspector.close"));
  window.key("f");
  EXPECT_LT(camera(5), distance);
  window.key("shift+f");
  window.click("inspector.close");
  EXPECT_TRUE(window.wait_for([](const Json& f) { return f["selection"].is_null(); }));

  // A new N keeps the state of existing bodies and is a physical change. A restart is a new run.
  window.type_into("settings.bodies", "500");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["bodies"] == 500; }));
  EXPECT_EQ(value("step"), paused_at + 5);
  EXPECT_EQ(value("edited"), true);
  window.move(640, 20);
  window.key("r");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] == 0; }));
  EXPECT_EQ(value("edited"), false);
  window.key("s");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] == 1; }));
  EXPECT_EQ(value("state_hash"), expected_hash(1, 500));

  // Impulses are recorded only while contacts are shown.
  EXPECT_EQ(value("max_impulse"), 0);
  window.click("layers.contacts");
  window.move(640, 20);
  std::int64_t state = 1;
  for (; state < 60 && value("max_impulse") == 0; ++state) {
    window.key("s");
    ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["step"] == state + 1; }));
  }
  EXPECT_GT(value("max_impulse"), 0);
  EXPECT_EQ(value("state_hash"), expected_hash(state, 500));
  window.click("layers.contacts");
  window.move(640, 20);
  window.key("s");
  ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["step"] == state + 1; }));
  EXPECT_EQ(value("max_impulse"), 0);

  // Unavailable items are grey, and a click on them has no effect.
  if (!cuda_available()) {
    window.click("settings.executor");
    const auto [left, cpu] = window.place("settings.executor.cpu");
    const int row = cpu - window.place("settings.executor.auto").second;
    EXPECT_FALSE(window.sees("settings.executor.cuda"));
    window.click_at(left, cpu + row);
    EXPECT_TRUE(window.frame()["error"].is_null()) << window.frame()["error"];
    EXPECT_TRUE(window.frame()["list_open"]);
    window.key("Escape");
    ASSERT_TRUE(window.wait_for([](const Json& f) { return f["list_open"] == false; }));
  }

  // An error is shown without terms of the command line, and the program continues as before.
  const std::filesystem::path pictures = window.file("captures"), aside = window.file("aside");
  std::filesystem::rename(pictures, aside);
  std::ofstream(pictures) << "in the way";
  window.click("timing.csv");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["error"].is_string(); }));
  EXPECT_THAT(window.frame()["error"].get<std::string>(), testing::HasSubstr("captures"));
  EXPECT_THAT(window.frame()["error"].get<std::string>(), testing::Not(testing::HasSubstr("--")));
  window.click("error.dismiss");
  EXPECT_TRUE(window.wait_for([](const Json& f) { return f["error"].is_null(); }));
  std::filesystem::remove(pictures);
  std::filesystem::rename(aside, pictures);
  window.key("s");
  EXPECT_TRUE(window.wait_for([&](const Json& f) { return f["step"] == state + 2; }));

  // Another window size, and folded panels.
  window.resize(1000, 760);
  const Image resized = picture(window);
  EXPECT_EQ(resized.width, 1000);
  EXPECT_EQ(resized.height, 760);
  window.click("fold.right");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return !f["widgets"].contains("panel.timing"); }));
  window.click("fold.right");
  window.click("timing.csv");
  EXPECT_TRUE(window.wait_for([](const Json& f) {
    return f["last_notice"].get<std::string>().starts_with("wrote captures/history_");
  }));
  window.click("panel.settings");  // folded, to make room
  window.click("view.light");
  EXPECT_TRUE(window.wait_for([](const Json& f) { return f["light"] == true; }));

  EXPECT_EQ(close(window), "");
  EXPECT_TRUE(std::filesystem::exists(window.file("config/collidoscope/settings.json")));
}

}  // namespace
}  // namespace collidoscope

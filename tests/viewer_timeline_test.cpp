// Tests the timeline of the window, by real mouse and key events: states are reached again with the same hash
// and the same picture.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/test_files.h"
#include "tests/viewer_fixture.h"

namespace collidoscope {
namespace {

class ViewerTimeline : public Viewer {
 protected:
  /// The state at which the window stays: requests before it may still be simulated. Compares its hash.
  static std::int64_t state_at_rest(WindowDriver& window) {
    std::int64_t state = -1, frame = 0;
    int frames = 0;
    EXPECT_TRUE(window.wait_for([&](const Json& f) {
      if (f["frame"] == frame) return false;
      frame = f["frame"];
      frames = f["state_hash"].is_string() && f["step"] == state ? frames + 1 : 0;
      state = f["step"];
      return frames == 8;  // one event of the mouse needs up to three frames
    }));
    const Json shown = window.frame();
    EXPECT_EQ(shown["step"], state);
    EXPECT_EQ(shown["state_hash"], expected_hash(state, 300));
    return state;
  }
};

TEST_F(ViewerTimeline, GoesBackAndForthByHand) {
  WindowDriver window({"box_collider", "--bodies", "300", "--steps", "120", "--size", "1280x720",
                       "--executor", "cpu", "--reset-ui"});
  const auto at = [&](std::int64_t state) {
    return window.wait_for([&](const Json& f) { return f["step"] == state && f["playing"] == false; });
  };
  // Without a tooltip.
  const auto still = [&] {
    window.move(640, 12);
    return picture(window);
  };
  ASSERT_TRUE(at(120));
  EXPECT_EQ(window.frame()["timeline"], Json({0, 120}));
  window.next_frame();
  const std::string last_hash = window.frame()["state_hash"];
  EXPECT_EQ(last_hash, expected_hash(120, 300));
  const Image last = still();

  // Step back, by button and key; each state has the hash of a run that reached it at once.
  window.click("run.back");
  ASSERT_TRUE(at(119));
  window.key("shift+s");
  ASSERT_TRUE(at(118));
  window.next_frame();
  EXPECT_EQ(window.frame()["state_hash"], expected_hash(118, 300));
  EXPECT_EQ(window.frame()["timeline"], Json({0, 120}));
  window.click("run.forward");
  window.key("s");
  ASSERT_TRUE(at(120));
  window.next_frame();
  EXPECT_EQ(window.frame()["state_hash"], last_hash);
  EXPECT_LT(difference(last, still(), window.frame()), 0.0005);

  // Drag to the start and to the middle.
  const Json slider = window.frame()["widgets"]["run.timeline"];
  const int x = slider[0].get<int>(), y = slider[1].get<int>() + slider[3].get<int>() / 2,
            w = slider[2].get<int>();
  window.drag(x + w - 6, y, x + 2, y);
  ASSERT_TRUE(at(0));
  window.next_frame();
  EXPECT_EQ(window.frame()["state_hash"], expected_hash(0, 300));
  EXPECT_GT(difference(last, still(), window.frame()), 0.01);
  window.drag(x + 6, y, x + w / 2, y);
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] > 40 && f["step"] < 80; }));
  const std::int64_t middle = state_at_rest(window);

  // A change there drops the later states; the run goes on from there.
  window.click("layers.spheres");  // no change of the state
  window.next_frame();
  EXPECT_EQ(window.frame()["timeline"], Json({0, 120}));
  window.type_into("settings.restitution", "0.1");
  ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["timeline"] == Json({0, middle}); }));
  EXPECT_EQ(window.frame()["changes"], 1);
  for (int k = 0; k < 3; ++k) window.key("s");
  ASSERT_TRUE(at(middle + 3));
  EXPECT_EQ(window.frame()["timeline"], Json({0, middle + 3}));
  window.next_frame();
  EXPECT_NE(window.frame()["state_hash"], expected_hash(middle + 3, 300));
  EXPECT_EQ(window.frame()["error"], Json(nullptr));
  EXPECT_EQ(close(window), "");
}

TEST_F(ViewerTimeline, ScrubsBranchesAndReturnsToTheOtherRun) {
  WindowDriver window({"box_collider", "--bodies", "300", "--steps", "100", "--size", "1280x800",
                       "--executor", "cpu", "--break", "speed=1000", "--reset-ui"});
  const auto at = [&](std::int64_t state) {
    return window.wait_for([&](const Json& f) {
      return f["step"] == state && f["playing"] == false && f["state_hash"].is_string();
    });
  };
  ASSERT_TRUE(at(100));
  const std::string last_hash = window.frame()["state_hash"];
  const auto on_strip = [&](double share) {
    const Json strip = window.frame()["widgets"]["timeline.strip"];
    return std::pair(static_cast<int>(strip[0].get<double>() + share * strip[2].get<double>()),
                     static_cast<int>(strip[1].get<double>() + 0.6 * strip[3].get<double>()));
  };
  // A drag on the strip goes through states.
  const auto [x0, y0] = on_strip(0.9);
  const auto [x1, y1] = on_strip(0.4);
  window.drag(x0, y0, x1, y1);
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] > 35 && f["step"] < 45; }));
  window.move(640, 12);
  state_at_rest(window);

  // A click on a graph goes to the state below the pointer.
  const Json graph = window.frame()["widgets"]["graph.energy"];
  window.click_at(static_cast<int>(graph[0].get<double>() + 0.75 * graph[2].get<double>()),
                  static_cast<int>(graph[1].get<double>() + 0.5 * graph[3].get<double>()));
  ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["step"] > 65 && f["step"] < 85; }));
  const std::int64_t clicked = state_at_rest(window);

  // Backwards to the start.
  window.move(640, 12);
  window.click("run.backwards");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["backwards"] == true; }));
  ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["step"] < clicked - 5; }));
  window.key("shift+space");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["backwards"] == false; }));
  state_at_rest(window);
  window.key("shift+space");
  ASSERT_TRUE(at(0)) << "it stops at the first state";
  EXPECT_EQ(window.frame()["state_hash"], expected_hash(0, 300));

  // A change in an earlier state starts a branch; the run until then is kept.
  const auto [x2, y2] = on_strip(0.5);
  window.click_at(x2, y2);
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] > 45 && f["step"] < 55; }));
  window.move(640, 12);
  const std::int64_t branch = state_at_rest(window);
  EXPECT_EQ(window.frame()["other_run"], Json(nullptr));
  window.type_into("settings.restitution", "0.1");
  ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["other_run"] == Json({branch, 100}); }));
  EXPECT_EQ(window.frame()["marks"],
            Json({Json({branch, "state " + std::to_string(branch) + ": restitution"})}));
  window.key("s");
  ASSERT_TRUE(at(branch + 1));
  const std::string branched = window.frame()["state_hash"];
  EXPECT_NE(branched, expected_hash(branch + 1, 300));
  window.click("timeline.other");
  ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["other_run"] == Json({branch, branch + 1}); }));
  EXPECT_EQ(window.frame()["timeline"], Json({0, 100}));
  ASSERT_TRUE(at(branch + 1));
  EXPECT_EQ(window.frame()["state_hash"], expected_hash(branch + 1, 300));
  EXPECT_DOUBLE_EQ(window.frame()["restitution"].get<double>(), 0.8);
  const Image other = picture(window);
  EXPECT_GT(other.width, 0);
  window.click("timeline.other");
  ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["timeline"] == Json({0, branch + 1}); }));
  ASSERT_TRUE(at(branch + 1));
  EXPECT_EQ(window.frame()["state_hash"], branched);
  EXPECT_EQ(window.frame()["error"], Json(nullptr));
  EXPECT_EQ(close(window), "");
}

TEST_F(ViewerTimeline, WritesItsRunAndOpensItAgain) {
  const TemporaryFolder folder;
  const std::vector<std::string> shared{"--size", "1280x800", "--executor", "cpu", "--reset-ui"};
  const auto at = [](WindowDriver& window, std::int64_t state) {
    return window.wait_for([&](const Json& f) {
      return f["step"] == state && f["playing"] == false && f["state_hash"].is_string();
    });
  };
  const auto with = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), shared.begin(), shared.end());
    return arguments;
  };
  std::string hash;
  double restitution = 0;
  {
    WindowDriver window(with({"box_collider", "--bodies", "300", "--steps", "60"}));
    ASSERT_TRUE(at(window, 60));
    window.click("settings.restitution");  // the middle of the slider
    ASSERT_TRUE(window.wait_for([](const Json& f) { return f["changes"] == 1; }));
    restitution = window.frame()["restitution"];
    window.move(640, 12);
    for (int k = 1; k <= 5; ++k) {
      window.key("s");
      ASSERT_TRUE(at(window, 60 + k));
    }
    hash = window.frame()["state_hash"];
    // From mark to mark.
    window.key("bracketleft");
    ASSERT_TRUE(at(window, 60));
    window.key("bracketleft");
    ASSERT_TRUE(
        window.wait_for([](const Json& f) { return f["last_notice"] == "no mark before this state"; }));
    window.key("shift+s");
    ASSERT_TRUE(at(window, 59));
    window.key("bracketright");
    ASSERT_TRUE(at(window, 60));
    window.key("ctrl+s");
    ASSERT_TRUE(window.wait_for([](const Json& f) {
      return f["last_notice"].is_string() &&
             f["last_notice"].get<std::string>().starts_with("wrote captures/run_");
    }));
    EXPECT_EQ(window.frame()["last_notice"], "wrote captures/run_000065.recording");
    std::filesystem::copy(window.file("captures/run_000065.recording"), folder / "run.recording");
    window.click("run.save");
    ASSERT_TRUE(window.wait_for(
        [](const Json& f) { return f["last_notice"] == "wrote captures/run_000065_2.recording"; }));
    EXPECT_EQ(window.frame()["error"], Json(nullptr));
    EXPECT_EQ(close(window), "");
  }
  WindowDriver window(with({(folder / "run.recording").string()}));
  ASSERT_TRUE(window.wait_for([](const Json& f) {
    return f["timeline"].is_array() && f["timeline"][0] == 0 && f["timeline"][1] >= 65;
  }));
  EXPECT_EQ(window.frame()["marks"], Json({Json({60, "state 60: restitution"})}));
  window.key("space");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["playing"] == false; }));
  window.key("bracketleft");
  ASSERT_TRUE(at(window, 60));
  EXPECT_DOUBLE_EQ(window.frame()["restitution"].get<double>(), restitution);
  EXPECT_LT(restitution, 0.7);
  window.key("shift+s");
  ASSERT_TRUE(at(window, 59));
  EXPECT_EQ(window.frame()["state_hash"], expected_hash(59, 300));
  EXPECT_DOUBLE_EQ(window.frame()["restitution"].get<double>(), 0.8);
  for (int k = 60; k <= 65; ++k) {
    window.key("s");
    ASSERT_TRUE(at(window, k));
  }
  EXPECT_EQ(window.frame()["state_hash"], hash);
  EXPECT_EQ(window.frame()["error"], Json(nullptr));
  EXPECT_EQ(close(window), "");
}

}  // namespace
}  // namespace collidoscope

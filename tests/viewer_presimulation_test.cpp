// Tests a presimulated scene in the window, by real events. The current run continues meanwhile and can be
// kept, and the next start is immediate.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>

#include "tests/viewer_fixture.h"

namespace collidoscope {
namespace {

class ViewerSettles : public Viewer {
 protected:
  static void choose(WindowDriver& window, const std::string& list, const std::string& choice) {
    window.click(list);
    ASSERT_TRUE(window.wait_for([](const Json& f) { return f["list_open"] == true; }));
    window.click(list + "." + choice);
    window.move(550, 300);  // away from the list, so that keys go to the run
  }
  /// The presimulation step shown in the notice; -1 without one.
  static int settling_step(const Json& frame) {
    int step = -1;
    std::sscanf(frame["last_notice"].get<std::string>().c_str(), "settling the bodies: step %d of", &step);
    return step;
  }
  static bool waits(const Json& frame) { return settling_step(frame) >= 0; }
  /// Whether a frame after this one waited, in state 1. It may have been a short time, so all are read.
  static bool waited_after(WindowDriver& window, std::int64_t frame) {
    std::ifstream stream(window.file("automation.jsonl"));
    for (std::string line; std::getline(stream, line) && !stream.eof();) {
      const Json one = Json::parse(line);
      if (one["frame"] > frame && one["step"] == 1 && waits(one)) return true;
    }
    return false;
  }
};

TEST_F(ViewerSettles, BesideTheRunThatThereIs) {
  WindowDriver window({"box_collider", "--variant", "scaled", "--bodies", "300", "--size", "1100x1000"});
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] >= 3; }));

  choose(window, "settings.variant", "settled");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["variant"] == "settled"; }, 120));
  EXPECT_EQ(window.frame()["bodies"], 300);
  EXPECT_FALSE(waits(window.frame()));

  // The presimulation takes long: the current run continues and is kept.
  window.type_into("settings.bodies", "20000");
  window.move(550, 300);
  ASSERT_TRUE(window.wait_for(waits));
  EXPECT_EQ(window.frame()["bodies"], 300);
  const int step = window.frame()["step"];
  ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["step"] > step + 2 && waits(f); }));
  const int activate = settling_step(window.frame());
  window.key("r");  // deferred
  ASSERT_TRUE(window.wait_for([&](const Json& f) { return settling_step(f) > activate; }));
  EXPECT_GT(window.frame()["step"], step);
  window.key("Escape");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["last_notice"] == "settling cancelled"; }));
  window.next_frame();
  EXPECT_EQ(window.frame()["bodies"], 300);
  EXPECT_FALSE(waits(window.next_frame()));

  // There and back: the state is cached, and the run starts in the frame of the request.
  choose(window, "settings.variant", "scaled");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["variant"] == "scaled"; }));
  window.key("space");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["playing"] == false; }));
  bool waited = false;
  choose(window, "settings.variant", "settled");
  ASSERT_TRUE(window.wait_for([&](const Json& f) {
    waited |= waits(f);
    return f["variant"] == "settled";
  }));
  EXPECT_FALSE(waited);
  EXPECT_EQ(window.frame()["step"], 0);
  const std::string at_rest = window.frame()["state_hash"];

  // Changed physics need another presimulation: the restart is deferred.
  window.key("s");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] == 1; }));
  choose(window, "settings.solver", "jacobi_split");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["solver"] == "jacobi_split"; }));
  const std::int64_t before = window.frame()["frame"];
  window.key("r");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] == 0; }, 120));
  EXPECT_TRUE(waited_after(window, before)) << "the run stayed at state 1 meanwhile";
  EXPECT_NE(window.next_frame()["state_hash"], at_rest);
  EXPECT_TRUE(window.frame()["error"].is_null());
  EXPECT_EQ(close(window), "");
}

}  // namespace
}  // namespace collidoscope

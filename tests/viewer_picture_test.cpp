// Tests the window's picture on the X server, and that the window continues if a picture cannot be written.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/viewer_fixture.h"

namespace collidoscope {
namespace {

using testing::HasSubstr;
using testing::Not;

void pause(WindowDriver& window) {
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] >= 2; }));
  window.move(560, 30);
  window.key("space");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["playing"] == false; }));
}

TEST_F(Viewer, ShowsWhatItDrewAtEverySize) {
  WindowDriver window({"box_collider", "--bodies", "300", "--size", "1100x700"});
  pause(window);
  EXPECT_EQ(shown_fault(window), "") << "at first";
  window.resize(1500, 950);
  EXPECT_EQ(shown_fault(window), "") << "larger";
  window.resize(900, 640);
  EXPECT_EQ(shown_fault(window), "") << "smaller";
  window.move_window(60, 40);
  EXPECT_EQ(shown_fault(window), "") << "moved";
  // Without a window manager, maximised means the size and position of the screen.
  window.move_window(0, 0);
  window.resize(1920, 1200);
  EXPECT_EQ(shown_fault(window), "") << "maximised";
  window.resize(900, 640);
  window.move_window(60, 40);
  EXPECT_EQ(shown_fault(window), "") << "restored";
  window.move_window(0, 0);
  EXPECT_EQ(close(window), "");
}

TEST_F(Viewer, GoesOnWhereNothingCanBeWritten) {
  WindowDriver window({"box_collider", "--bodies", "100", "--size", "1280x720"});
  pause(window);
  std::ofstream(window.file("captures")) << "a file, where the folder should be";
  const std::int64_t before = window.frame()["frame"];
  window.key("p");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["error"].is_string(); }));
  const std::string error = window.frame()["error"];
  EXPECT_THAT(error, HasSubstr("Cannot create folder captures"));
  for (const char* word : {"filesystem", "std::", "error:", "[", "create_directories"})
    EXPECT_THAT(error, Not(HasSubstr(word)));
  // The message is shown in its red bar, and drawing continues.
  window.next_frame();
  EXPECT_GT(window.frame()["frame"], before);
  const auto [x, y] = window.place("error.dismiss");
  const Image shown = window.shown();
  const std::size_t at = 4 * (static_cast<std::size_t>(y - 20) * static_cast<std::size_t>(shown.width) +
                              static_cast<std::size_t>(x));
  EXPECT_GT(shown.rgba[at], 90) << "red";
  EXPECT_LT(shown.rgba[at + 1], 90) << "no green";
  window.click("error.dismiss");
  EXPECT_TRUE(window.wait_for([](const Json& f) { return f["error"].is_null(); })) << "it is not tried again";
  const std::int64_t state = window.frame()["step"];
  window.move(560, 30);
  window.key("s");
  EXPECT_TRUE(window.wait_for([&](const Json& f) { return f["step"] == state + 1; }));

  // The other files that the window writes.
  for (const char* widget : {"timing.csv", "timing.json"}) {
    window.click(widget);
    ASSERT_TRUE(window.wait_for([](const Json& f) { return f["error"].is_string(); })) << widget;
    EXPECT_THAT(window.frame()["error"].get<std::string>(), HasSubstr("annot create folder captures"))
        << widget;
    window.click("error.dismiss");
    EXPECT_TRUE(window.wait_for([](const Json& f) { return f["error"].is_null(); })) << widget;
  }

  // The run continues to play.
  window.move(560, 30);
  window.key("space");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["playing"] == true; }));
  window.key("p");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["error"].is_string(); }));
  EXPECT_EQ(window.frame()["playing"], true);
  window.click("error.dismiss");
  window.move(560, 30);
  window.key("space");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["playing"] == false; }));

  // When the path is free again, the picture is written.
  std::filesystem::remove(window.file("captures"));
  window.move(560, 30);
  EXPECT_EQ(picture(window).width, 1280);
  EXPECT_EQ(close(window), "");
}

}  // namespace
}  // namespace collidoscope

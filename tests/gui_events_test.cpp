// Tests how the installed version of Dear ImGui handles single input events. The viewer depends on this
// behaviour.
#include "viewer/gui_events.h"

#define GLFW_INCLUDE_NONE  // libepoxy declares OpenGL, for other files of a unity batch
#include <GLFW/glfw3.h>
#include <gtest/gtest.h>
#include <imgui.h>

#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include "viewer/gui_input.h"

namespace collidoscope {
namespace {

using Kind = InputEvent::Kind;

InputEvent key(int code, bool down) {
  InputEvent event{Kind::key};
  event.code = code;
  event.down = down;
  return event;
}

bool is_down(ImGuiKey name) { return ImGui::IsKeyDown(ImGui::GetKeyIndex(name)); }

class GuiEventsTest : public testing::Test {
 protected:
  void SetUp() override {
    context_ = ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.DisplaySize = {640, 480};
    unsigned char* pixels = nullptr;
    int width = 0, height = 0;
    io.Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
    events_ = std::make_unique<GuiEvents>();
    frame({});
  }
  void TearDown() override {
    ImGui::EndFrame();
    ImGui::DestroyContext(context_);
  }

  /// Ends the frame and begins a new one with these events.
  void frame(const std::vector<InputEvent>& events) {
    if (begun_) ImGui::EndFrame();
    begun_ = true;
    for (const InputEvent& event : events) events_->add(event);
    ImGui::GetIO().DeltaTime = 1.0f / 60;
    ImGui::NewFrame();
  }

  ImGuiContext* context_ = nullptr;
  std::unique_ptr<GuiEvents> events_;
  bool begun_ = false;
};

TEST_F(GuiEventsTest, AKeyIsDownFromItsPressToItsRelease) {
  const std::pair<int, ImGuiKey> keys[] = {{GLFW_KEY_TAB, ImGuiKey_Tab},
                                           {GLFW_KEY_LEFT, ImGuiKey_LeftArrow},
                                           {GLFW_KEY_END, ImGuiKey_End},
                                           {GLFW_KEY_DELETE, ImGuiKey_Delete},
                                           {GLFW_KEY_ENTER, ImGuiKey_Enter},
                                           {GLFW_KEY_BACKSPACE, ImGuiKey_Backspace},
                                           {GLFW_KEY_ESCAPE, ImGuiKey_Escape},
                                           {GLFW_KEY_A, ImGuiKey_A},
                                           {GLFW_KEY_Z, ImGuiKey_Z}};
  for (const auto& [code, name] : keys) {
    EXPECT_FALSE(is_down(name)) << code;
    frame({key(code, true)});
    EXPECT_TRUE(is_down(name)) << code;
    EXPECT_TRUE(ImGui::IsKeyPressed(ImGui::GetKeyIndex(name))) << code;
    frame({});
    EXPECT_TRUE(is_down(name)) << code;
    EXPECT_FALSE(ImGui::IsKeyPressed(ImGui::GetKeyIndex(name))) << code;
    frame({key(code, false)});
    EXPECT_FALSE(is_down(name)) << code;
  }
}

TEST_F(GuiEventsTest, AModifierIsDownWhileOneOfItsKeysIs) {
  const ImGuiIO& io = ImGui::GetIO();
  frame({key(GLFW_KEY_LEFT_CONTROL, true), key(GLFW_KEY_RIGHT_CONTROL, true)});
  EXPECT_TRUE(io.KeyCtrl);
  EXPECT_FALSE(io.KeyShift || io.KeyAlt || io.KeySuper);
  frame({key(GLFW_KEY_LEFT_CONTROL, false)});
  EXPECT_TRUE(io.KeyCtrl);
  frame({key(GLFW_KEY_RIGHT_CONTROL, false), key(GLFW_KEY_RIGHT_SHIFT, true), key(GLFW_KEY_LEFT_ALT, true),
         key(GLFW_KEY_RIGHT_SUPER, true)});
  EXPECT_FALSE(io.KeyCtrl);
  EXPECT_TRUE(io.KeyShift && io.KeyAlt && io.KeySuper);
}

TEST_F(GuiEventsTest, LosingTheKeyboardReleasesAllKeys) {
  InputEvent focus{Kind::focus};
  focus.down = false;
  frame({key(GLFW_KEY_LEFT_CONTROL, true), key(GLFW_KEY_A, true)});
  EXPECT_TRUE(is_down(ImGuiKey_A) && ImGui::GetIO().KeyCtrl);
  frame({focus});
  frame({key(GLFW_KEY_TAB, true)});
  EXPECT_FALSE(is_down(ImGuiKey_A));
  frame({key(GLFW_KEY_RIGHT_SHIFT, true)});
  EXPECT_FALSE(ImGui::GetIO().KeyCtrl);
}

TEST_F(GuiEventsTest, AFrameHandlesAllEventsThatWereAdded) {
  InputEvent move{Kind::move}, press{Kind::button}, wheel{Kind::wheel}, character{Kind::character};
  move.x = 30, move.y = 40;
  press.code = GLFW_MOUSE_BUTTON_RIGHT;
  press.down = true;
  wheel.x = 1, wheel.y = -2;
  character.character = 'q';
  frame({move, key(GLFW_KEY_A, true), press, wheel, character});
  const ImGuiIO& io = ImGui::GetIO();
  EXPECT_EQ(io.MousePos.x, 30);
  EXPECT_EQ(io.MousePos.y, 40);
  EXPECT_TRUE(ImGui::IsMouseClicked(ImGuiMouseButton_Right));
  EXPECT_EQ(io.MouseWheelH, 1);
  EXPECT_EQ(io.MouseWheel, -2);
  EXPECT_TRUE(is_down(ImGuiKey_A));
  ASSERT_EQ(io.InputQueueCharacters.Size, 1);
  EXPECT_EQ(io.InputQueueCharacters[0], 'q');
}

TEST_F(GuiEventsTest, CodesOutsideAllRangesDoNothing) {
  InputEvent press{Kind::button};
  press.down = true;
  std::vector<InputEvent> events;
  for (const int code : {-1, 8, 1000, 100000}) {
    events.push_back(key(code, true));
    press.code = code;
    events.push_back(press);
  }
  frame(events);
  for (int button = 0; button < ImGuiMouseButton_COUNT; ++button) EXPECT_FALSE(ImGui::IsMouseDown(button));
}

// Repeats of a held key during slow frames do not delay a click.
TEST(GuiInputTest, ARepeatedKeyTakesOneFrame) {
  std::deque<InputEvent> events{key(GLFW_KEY_W, true)};
  for (int k = 0; k < 100; ++k) {
    events.push_back(key(GLFW_KEY_W, true));
    events.back().repeat = true;
    events.push_back(InputEvent{Kind::character});
    events.back().character = 'w';
  }
  events.push_back(key(GLFW_KEY_W, false));
  events.push_back(InputEvent{Kind::button});
  events.back().down = true;
  const std::vector<InputEvent> first = take_events_of_a_frame(events);
  EXPECT_EQ(first.size(), 101u) << "one press, and every character";
  EXPECT_FALSE(first.front().repeat);
  const std::vector<InputEvent> second = take_events_of_a_frame(events);
  ASSERT_EQ(second.size(), 2u) << "the release and the click";
  EXPECT_FALSE(second[0].down);
  EXPECT_EQ(second[1].kind, Kind::button);
  EXPECT_TRUE(events.empty());
  // A press after a release is no repeat: each event has its own frame.
  events = {key(GLFW_KEY_W, true), key(GLFW_KEY_W, false), key(GLFW_KEY_W, true)};
  for (int k = 0; k < 3; ++k) EXPECT_EQ(take_events_of_a_frame(events).size(), 1u);
}

}  // namespace
}  // namespace collidoscope

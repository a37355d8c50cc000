// The viewer, driven through its window by real mouse and key events.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>

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
  EXPECT_THAT(wrong.err, testing::HasSubstr("two: one argument too many"));
  const Outcome blind = run_program(program, {"--bodies", "10"});
  EXPECT_EQ(blind.status, 3);
  EXPECT_THAT(blind.err, testing::HasSubstr("no window"));
}

TEST_F(Viewer, ObeysMouseAndKeys) {
  WindowDriver window({"box_collider", "--bodies", "300", "--size", "1280x720"});
  const auto value = [&](const char* name) { return window.frame()[name]; };

  // Opens playing; pauses, steps.
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

  // Every layer, seen in the picture and in what is drawn.
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
    EXPECT_TRUE(name != "boxes" || value("drawn")["boxes"] > 300);
    EXPECT_TRUE(name != "contacts" || value("drawn")["contacts"] > 0);
    EXPECT_TRUE(name != "spheres" || value("drawn")["spheres"] == 0);
    window.click(std::string("layers.") + layer);
    ASSERT_TRUE(window.wait_for([&](const Json& f) { return f["layers"][layer] == was; })) << layer;
  }
  window.move(640, 20);
  EXPECT_LT(difference(plain, picture(window), window.frame()), 0.0005) << "all as before";

  // (B, T): typed, and by the slider; nothing of it reaches the state.
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

  // The camera: turned, pulled nearer, pushed aside, along an axis, without perspective.
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

  // A click selects what is under it; the inspector says so, and is closed.
  for (int k = 0; k < 12 && window.frame()["selection"].is_null(); ++k)
    window.click_at(560 + 14 * k, 420 - 6 * k);
  ASSERT_FALSE(value("selection").is_null());
  EXPECT_TRUE(window.sees("inspector.close"));
  window.key("f");
  EXPECT_LT(camera(5), distance);
  window.key("shift+f");
  window.click("inspector.close");
  EXPECT_TRUE(window.wait_for([](const Json& f) { return f["selection"].is_null(); }));

  // A new N keeps the others' state, and is a physical change; a restart is a run of its own.
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

  // Impulses are known where contacts are shown, and cost nothing where they are not.
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

  // An error shows, and the program lives on with what it had.
  if (!cuda_available()) {
    window.click("settings.executor");
    window.click("settings.executor.cuda");
    ASSERT_TRUE(window.wait_for([](const Json& f) { return f["error"].is_string(); }));
    window.click("error.dismiss");
    EXPECT_TRUE(window.wait_for([](const Json& f) { return f["error"].is_null(); }));
    window.key("s");
    EXPECT_TRUE(window.wait_for([&](const Json& f) { return f["step"] == state + 2; }));
  }

  // Another size, and panels folded away.
  window.resize(1000, 760);
  const Image resized = picture(window);
  EXPECT_EQ(resized.width, 1000);
  EXPECT_EQ(resized.height, 760);
  window.click("fold.right");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return !f["widgets"].contains("panel.timing"); }));
  window.click("fold.right");
  window.click("timing.csv");
  EXPECT_TRUE(window.wait_for(
      [](const Json& f) { return f["notice"].get<std::string>().starts_with("wrote captures/history_"); }));
  window.click("view.light");
  EXPECT_TRUE(window.wait_for([](const Json& f) { return f["light"] == true; }));

  EXPECT_EQ(close(window), "");
  EXPECT_TRUE(std::filesystem::exists(window.file("config/collidoscope/settings.json")));
}

/// Hands that do anything, anywhere: what was touched least comes first, so that a long walk leaves nothing
/// out.
class Walker {
 public:
  Walker(WindowDriver& window, unsigned seed) : window_(window), random_(seed) {}

  void step() {
    const Json widgets = window_.frame()["widgets"];
    for (const auto& [name, rect] : widgets.items()) touched_.try_emplace(name, 0);
    switch (pick(16)) {
      case 0:
      case 1:
      case 2:
        key();
        break;
      case 3:
        scroll(widgets);
        break;
      case 4:
        if (pick(4) == 0) resize();
        break;
      case 5:
        choose_body(widgets);
        break;
      default:
        touch(widgets);
    }
  }

  /// How often each widget that was ever seen was clicked, dragged or typed into.
  const std::map<std::string, int>& touched() const { return touched_; }
  const std::string& trail() const { return trail_; }

 private:
  std::size_t pick(std::size_t n) { return static_cast<std::size_t>(random_() % n); }
  int within(const Json& rect, std::size_t axis) {
    return static_cast<int>(rect[axis].get<double>() +
                            static_cast<double>(pick(1000)) / 1000 * rect[axis + 2].get<double>());
  }
  void note(const std::string& what) { trail_ += what + ' '; }

  void key() {
    static constexpr const char* keys[] = {"space", "s",      "r",  "f",   "1",       "3", "5",
                                           "7",     "Escape", "F1", "Tab", "shift+f", "w", "Return"};
    const std::string name = keys[pick(std::size(keys))];
    note(name);
    window_.key(name);
  }

  void scroll(const Json& widgets) {
    if (widgets.empty()) return;
    auto any = widgets.begin();
    std::advance(any, static_cast<std::ptrdiff_t>(pick(widgets.size())));
    note("wheel:" + any.key());
    window_.hands({"mousemove", std::to_string(within(*any, 0)), std::to_string(within(*any, 1)), "click",
                   "--repeat", std::to_string(1 + pick(12)), pick(2) ? "4" : "5"});
    window_.next_frame();
  }

  void resize() {
    static constexpr int sizes[][2] = {{1100, 720}, {1280, 720}, {640, 480}, {320, 240}, {1500, 1100}};
    const auto& [width, height] = sizes[pick(std::size(sizes))];
    note(std::to_string(width) + "x" + std::to_string(height));
    window_.resize(width, height);
    // So small a window hides most of what there is to touch.
    if (width < 1000) window_.resize(1100, 720);
  }

  /// Of the many that are in the middle of the view.
  void choose_body(const Json& widgets) {
    if (!widgets.contains("scene")) return;
    const Json& rect = widgets["scene"];
    const auto near_middle = [&](std::size_t axis, double share) {
      return static_cast<int>(rect[axis].get<double>() +
                              (share + 0.01 * static_cast<double>(pick(20))) * rect[axis + 2].get<double>());
    };
    note("body");
    window_.click_at(near_middle(0, 0.4), near_middle(1, 0.5));
  }

  void touch(const Json& widgets) {
    if (widgets.empty()) return;
    std::vector<std::string> names;
    for (const auto& [name, rect] : widgets.items()) names.push_back(name);
    std::ranges::shuffle(names, random_);
    if (pick(3) != 0) std::ranges::stable_sort(names, {}, [&](const std::string& n) { return touched_[n]; });
    // A list that has just unfolded closes again at a click elsewhere.
    std::ranges::stable_partition(names, [&](const std::string& n) { return n.starts_with(last_ + "."); });
    const std::string name = names.front();
    const Json& rect = widgets[name];
    ++touched_[name];
    last_ = name;
    note(name);
    const int x = within(rect, 0), y = within(rect, 1);
    const bool number = name == "settings.bodies" || name == "settings.blocks" ||
                        name == "settings.threads" || name == "settings.rate" || name == "settings.radius" ||
                        name == "settings.seed";
    if (number && pick(2)) {
      // Machines differ in how many bodies they can hold.
      static constexpr const char* texts[] = {"0", "1", "7", "60", "250", "-3", "0.5", "nonsense", "1e2"};
      window_.click_at(x, y);
      window_.type(texts[pick(std::size(texts))]);
    } else if (pick(4) == 0) {
      window_.drag(x, y, within(rect, 0), within(rect, 1), pick(3) == 0 ? 3 : 1);
    } else {
      window_.click_at(x, y);
    }
  }

  WindowDriver& window_;
  std::mt19937 random_;
  std::map<std::string, int> touched_;
  std::string trail_;
  std::string last_ = "nothing";  ///< touched
};

// COLLIDOSCOPE_WALK_SECONDS=300 makes it long, COLLIDOSCOPE_WALK_SEED another walk.
TEST_F(Viewer, SurvivesARandomWalk) {
  const auto from_environment = [](const char* name, int otherwise) {
    const char* text = std::getenv(name);
    return text ? std::atoi(text) : otherwise;
  };
  const int seconds = from_environment("COLLIDOSCOPE_WALK_SECONDS", 12);
  WindowDriver window({"box_collider", "--bodies", "200", "--size", "1100x720"});
  Walker walker(window, static_cast<unsigned>(from_environment("COLLIDOSCOPE_WALK_SEED", 1)));
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(seconds);
  int steps = 0;
  for (; std::chrono::steady_clock::now() < end && window.running(); ++steps) walker.step();
  ASSERT_TRUE(window.running()) << "after " << walker.trail() << "\n" << window.errors();
  EXPECT_EQ(close(window), "") << walker.trail();

  const std::map<std::string, int>& touched = walker.touched();
  const auto missed = std::ranges::count_if(touched, [](const auto& one) { return one.second == 0; });
  std::printf("%d steps, %zu widgets seen, %td of them never touched\n", steps, touched.size(), missed);
  if (seconds < 200 || steps < 1500) return;
  // Within scrolled panels, lists that unfold, and what only a selected body shows.
  for (const char* name :
       {"settings.seed", "view.picture", "timing.json", "run.speed.2 ×", "layers.color.order in the tree",
        "settings.variant.scaled", "settings.broad_phase.brute_force", "inspector.follow",
        "inspector.contact.0", "layers.levels", "panel.tree", "tree.row.0", "tree.spread", "graph.momentum",
        "scene"})
    EXPECT_TRUE(touched.contains(name) && touched.at(name) > 0) << name;
}

}  // namespace
}  // namespace collidoscope

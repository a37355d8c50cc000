// Tests the viewer with random input on all its widgets.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "sim_cuda/scene/broad_phase_methods.h"
#include "tests/hard_case_folder.h"
#include "tests/viewer_fixture.h"
#include "tests/window_walker.h"

namespace collidoscope {
namespace {

/// Widgets that a long walk must reach: every choice of every list, and widgets in scrolled or folded panels
/// or shown only for a selected body, node or query.
std::vector<std::string> named_widgets() {
  std::vector<std::string> names{"scene",
                                 "run.back",
                                 "run.timeline",
                                 "run.backwards",
                                 "timeline.strip",
                                 "run.forward",
                                 "graph.momentum",
                                 "timing.json",
                                 "timing.keys",
                                 "panel.numbers",
                                 "settings.seed",
                                 "view.picture",
                                 "layers.levels",
                                 "layers.contacts",
                                 "camera.ortho",
                                 "tree.sort.SAH",
                                 "tree.row.0",
                                 "tree.page.next",
                                 "tree.next",
                                 "tree.spread",
                                 "tree.auto",
                                 "tree.frame",
                                 "tree.query.play",
                                 "tree.query.at",
                                 "inspector.path",
                                 "error.dismiss",
                                 "inspector.follow",
                                 "inspector.close",
                                 "panel.inspector",
                                 "fold.left",
                                 "settings.threads.auto",
                                 "settings.substeps.auto",
                                 "settings.iterations.slider",
                                 "panel.convergence",
                                 "panel.accuracy",
                                 "panel.hard_cases",
                                 "hard_cases.run_all",
                                 "hard_cases.run",
                                 "hard_cases.case.falls",
                                 "hard_cases.mark.falls.soft_step f32",
                                 "hard_cases.back",
                                 "panel.breaks",
                                 "breaks.non-finite",
                                 "breaks.speed",
                                 "breaks.speed.limit",
                                 "effects.guards",
                                 "layers.ghosts",
                                 "layers.errors"};
  const auto list = [&](const std::string& name, const std::vector<std::string>& choices) {
    for (const std::string& choice : choices) names.push_back(name + "." + choice);
  };
  list("run.speed", {"0.1 ×", "0.25 ×", "0.5 ×", "1 × real time", "2 ×", "1 step per frame"});
  list("settings.executor", {"auto", "cpu"});
  list("settings.precision", {"f32", "f64"});
  list("settings.solver", {"impulse", "soft_step"});
  list("settings.integrator", {"velocity_verlet", "rk4", "semi_implicit_euler"});
  list("settings.variant", {"paper", "scaled", "settled", "equal"});
  for (const char* methods : {"settings.broad_phase", "tree.method"}) list(methods, broad_phase_names());
  list("layers.color", {"speed", "radius", "id", "contacts", "order in the tree", "depth in the tree",
                        "visits of the query"});
  for (const char* colors : {"layers.box_color", "tree.color"})
    list(colors, {"level", "SAH share", "sibling overlap", "empty space", "visits"});
  return names;
}

// COLLIDOSCOPE_WALK_SECONDS sets the duration (300 for a long walk), COLLIDOSCOPE_WALK_SEED the seed.
TEST_F(Viewer, SurvivesARandomWalk) {
  const auto from_environment = [](const char* name, int otherwise) {
    const char* text = std::getenv(name);
    return text ? std::atoi(text) : otherwise;
  };
  const int seconds = from_environment("COLLIDOSCOPE_WALK_SECONDS", 12);
  HardCaseFolder cases;  // few, so that the walk reaches all
  WindowDriver window({"box_collider", "--bodies", "1000", "--size", "1100x960", "--cases", cases.path()});
  WindowWalker walker(window, static_cast<unsigned>(from_environment("COLLIDOSCOPE_WALK_SEED", 1)));
  std::vector<std::string> missing = named_widgets();
  const std::size_t named = missing.size();
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(seconds);
  int steps = 0, complete = 0;
  for (; std::chrono::steady_clock::now() < end && window.running(); ++steps) {
    walker.step();
    if (missing.empty()) continue;
    std::erase_if(missing, [&](const std::string& name) {
      const auto found = walker.widgets().find(name);
      return found != walker.widgets().end() && found->second.presses > 0;
    });
    complete = walker.touches();
  }
  ASSERT_TRUE(window.running()) << "after " << walker.trail() << "\n" << window.errors();
  EXPECT_EQ(close(window), "") << walker.trail();

  // Every widget visible long enough must have been pressed. The walker prefers the least touched widget in
  // three of four touches, so a widget may wait while others have their turn.
  const int seen = static_cast<int>(walker.widgets().size());
  std::vector<std::string> passed_over;
  int pressed = 0;
  for (const auto& [name, widget] : walker.widgets()) {
    pressed += widget.presses > 0;
    if (widget.presses == 0 && widget.offers > 2 * seen) passed_over.push_back(name);
  }
  EXPECT_THAT(passed_over, testing::IsEmpty());
  std::printf("%d steps, %d touches; %d of %d widgets seen were pressed, %zu of %zu named ones by touch %d\n",
              steps, walker.touches(), pressed, seen, named - missing.size(), named, complete);
  // A choice needs two touches, and a hidden widget as many again until it is found. The factor of two allows
  // for chance.
  if (walker.touches() < 5 * seen)
    std::printf("a walk that must find all has %d touches: %s\n", 5 * seen,
                testing::PrintToString(missing).c_str());
  else
    EXPECT_THAT(missing, testing::IsEmpty());
}

}  // namespace
}  // namespace collidoscope

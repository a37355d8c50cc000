// Tests pictures of the panels against goldens. The viewer draws the panels with the same function.

#include "headless/pictures/panel_picture.h"

#include <gtest/gtest.h>
#include <imgui.h>

#include <algorithm>
#include <limits>
#include <set>

#include "tests/executors.h"
#include "tests/gl_fixture.h"
#include "tests/golden.h"
#include "tests/single_panel.h"
#include "tests/test_files.h"
#include "ui/panels.h"
#include "ui/plot.h"
#include "ui/theme.h"
#include "viewer/render/interop/display_link.h"
#include "viewer/render/value_range.h"
#include "viewer/render/window_frame.h"

namespace collidoscope {
namespace {

constexpr int panel_width = 1280, panel_height = 720;

Scene small_box(std::int64_t bodies) {
  Scene scene;
  scene.name = "Box Collider";
  scene.box = Box{};
  BoxCollider generator;
  generator.count = bodies;
  scene.generators.push_back(generator);
  return scene;
}

/// A world at state 40 with its panels.
struct Desk {
  explicit Desk(
      const FrameLayers& shown = {.spheres = true, .boxes = true, .first_level = 2, .last_level = 4},
      const Scene& scene = small_box(300))
      : layers(shown),
        world(scene, on_cpu(/*threads=*/2)),
        panels(world, shown, panel_width, panel_height, false) {
    world.records().record_impulses(shown.contacts);
    for (int k = 0; k < 40; ++k) {
      world.step();
      panels.record(world);
    }
    panels.set_renderer("a renderer", true, "CPU + upload");
  }

  Image draw() {
    const ScreenRect rect = PanelPicture::scene_rect(panel_width, panel_height);
    Renderer renderer(static_cast<int>(rect.width), static_cast<int>(rect.height));
    renderer.set_scene(frame_scene(world.scene(), world.initial()));
    const StepStats stats = world.measure();
    DisplayLink link(world.info(), DisplayPath::automatic, [](const std::string&) {});
    panels.refresh(world, renderer);
    link.publish(world, layers, renderer.instances());
    const ValueRange range = value_range(world, renderer.scene(), layers, stats);
    const double aspect = static_cast<double>(rect.width) / static_cast<double>(rect.height);
    renderer.draw(scene_camera({}, renderer.scene().bounds, aspect), layers, range);
    GuiPass gui(workspace_font_size(panel_width, panel_height, 1));
    return panels.draw(gui, world, stats, renderer, range);
  }

  FrameLayers layers;
  World world;
  PanelPicture panels;
};

TEST(PanelPicture, Dark) {
  test_context();
  EXPECT_TRUE(looks_like_golden<"workspace_dark">(Desk().draw()));
}

TEST(PanelPicture, Light) {
  test_context();
  Desk desk({.spheres = true, .contacts = true, .color = BodyColor::radius});
  desk.panels.workspace().theme = Theme::light;
  EXPECT_TRUE(looks_like_golden<"workspace_light">(desk.draw()));
}

// Effects that are on, one switched off, and greyed ones with the reason. Bytes are shown, times are not.
TEST(PanelPicture, Effects) {
  test_context();
  Scene scene = small_box(300);
  scene.materials[0].friction = 0.4;
  scene.materials[0].rolling_resistance = 0.02;
  scene.physics.effects = Effects{.gravity = true, .rotation = true, .friction = true};
  Desk desk({.spheres = true}, scene);
  desk.panels.workspace().visible_panels.effects = true;
  EffectCosts& costs = desk.panels.costs();
  costs.begin(desk.world);
  while (!costs.done()) costs.advance(desk.world, 1e9);
  EXPECT_TRUE(looks_like_golden<"workspace_effects">(desk.draw()));
}

FrameLayers tree_layers(NodeMetric metric) {
  FrameLayers layers{.spheres = true, .boxes = true, .first_level = 3, .ui = true, .tree = true};
  layers.box_color = metric;
  return layers;
}

// The worst node of the table is selected: thick lines, and two colours for its children.
TEST(PanelPicture, TreeWithItsWorstNode) {
  test_context();
  Desk desk(tree_layers(NodeMetric::empty_space));
  desk.layers.box_low = 0.7f;
  Workspace& workspace = desk.panels.workspace();
  workspace.layers.box_low = 0.7f;
  workspace.tree.sort = NodeMetric::empty_space;
  workspace.tree.rank = 0;
  const Image picture = desk.draw();
  EXPECT_TRUE(workspace.tree.node.has_value());
  EXPECT_TRUE(looks_like_golden<"workspace_tree">(picture));
}

// A body's query, halfway: overlapping and separate boxes in two colours, the current box bright.
TEST(PanelPicture, TreeWithAQuery) {
  test_context();
  Desk desk(tree_layers(NodeMetric::visits));
  desk.layers.boxes = desk.panels.workspace().layers.boxes = false;
  Workspace& workspace = desk.panels.workspace();
  workspace.theme = Theme::light;
  workspace.selection = 17;
  workspace.tree.query = true;
  workspace.tree.visit = 20;
  EXPECT_TRUE(looks_like_golden<"workspace_query">(desk.draw()));
}

/// Residuals of a pile at rest: two substeps of soft_step with three iterations each. They are constants, so
/// a better solver does not change the picture.
std::vector<Residual> residuals_of_a_pile() {
  constexpr double rms[] = {6.30e-5, 1.52e-5, 5.37e-6, 1.93e-6, 6.39e-5, 2.36e-5, 4.93e-6, 0,
                            6.12e-5, 1.45e-5, 3.54e-6, 1.02e-6, 6.22e-5, 2.41e-5, 4.71e-6, 6.19e-7};
  std::vector<Residual> residuals;
  for (int k = 0; k < 16; ++k)
    residuals.push_back({k / 4 % 2 == 0 ? "solve" : "relax", k / 8, k % 4, 345, rms[k], 9 * rms[k]});
  return residuals;
}

/// An effect whose cost is between `low` and `high` ms at a confidence of 95 %.
EffectView costly(double low, double high) {
  EffectView effect;
  effect.name = "rotation";
  effect.flag = &Effects::rotation;
  effect.on = effect.required = true;
  effect.cost.emplace();
  effect.cost->without_ms = 10;
  effect.cost->ratio = {1.0604, 1 + low / 10, 1 + high / 10, 20};
  return effect;
}

// A cost that is not significantly different from 0 is grey. The panel explains the colour.
TEST(PanelPicture, ACostThatIsNotKnownFromZeroIsGrey) {
  test_context();
  const auto picture = [&](double low, double high) {
    SinglePanel alone(draw_effects_panel, 338, 190);
    alone.workspace.visible_panels.effects = true;
    alone.view.effect_views = {costly(low, high)};
    return alone.picture();
  };
  // Both pictures show ±2.000. Only the second interval excludes 0.
  const Image noise = picture(-1.5, 2.5), real = picture(0.1, 4.1);
  const auto brightest = [&](const Image& image) {  // of the row's number
    int most = 0;
    for (int y = 50; y < 75; ++y)
      for (int x = 155; x < 204; ++x)
        most = std::max<int>(most, image.rgba[4 * static_cast<std::size_t>(y * image.width + x) + 1]);
    return most;
  };
  EXPECT_GT(brightest(real), brightest(noise) + 30);
  EXPECT_FALSE(costly(-1.8, 3.0).cost->ratio.differs()) << "+0.604 ± 2.4 ms";
  EXPECT_TRUE(costly(0.5, 0.7).cost->ratio.differs());
  EXPECT_TRUE(costly(-0.7, -0.5).cost->ratio.differs());
}

Image picture_of_convergence(Theme theme, ImVec2 pointer) {
  SinglePanel alone(draw_convergence_panel, 338, 190);
  alone.workspace.theme = theme;
  alone.workspace.visible_panels.convergence = true;
  alone.view.residuals = residuals_of_a_pile();
  alone.pointer = pointer;
  return alone.picture();
}

// The residual of each iteration on a logarithmic scale. A residual of 0 is at the bottom.
TEST(PanelPicture, Convergence) {
  test_context();
  EXPECT_TRUE(looks_like_golden<"convergence_dark">(picture_of_convergence(Theme::dark, {-1, -1})));
  EXPECT_TRUE(looks_like_golden<"convergence_light">(picture_of_convergence(Theme::light, {262, 60})));
}

TEST(PanelPicture, RepeatsItself) {
  test_context();
  Desk desk, other;
  EXPECT_EQ(desk.draw(), other.draw());
}

TEST(PanelPicture, EveryWidgetHasANameOfItsOwnAndAPlace) {
  test_context();
  std::set<std::string> all;
  for (const bool tree : {false, true}) {
    Desk desk(tree ? tree_layers(NodeMetric::visits) : FrameLayers{.spheres = true, .boxes = true});
    desk.panels.workspace().selection = 3;
    desk.panels.workspace().tree.query = true;
    desk.draw();
    std::set<std::string> names;
    for (const auto& [name, rect] : desk.panels.workspace().widgets) {
      EXPECT_TRUE(names.insert(name).second) << name;
      EXPECT_TRUE(rect.x >= 0 && rect.y >= 0 && rect.x + rect.width <= panel_width &&
                  rect.y + rect.height <= panel_height)
          << name;
      EXPECT_TRUE(rect.width > 0 && rect.height > 0) << name;
    }
    all.merge(names);
  }
  for (const char* name : {"run.play",
                           "run.step",
                           "settings.bodies",
                           "settings.blocks.slider",
                           "settings.threads.auto",
                           "layers.spheres",
                           "layers.levels",
                           "layers.box_color",
                           "timing.csv",
                           "panel.convergence",
                           "panel.accuracy",
                           "panel.hard_cases",
                           "panel.breaks",
                           "tree.method",
                           "tree.levels",
                           "tree.boxes",
                           "tree.color",
                           "tree.spread",
                           "tree.auto",
                           "tree.sort.visits",
                           "tree.row.7",
                           "tree.page.next",
                           "tree.next",
                           "tree.query.at",
                           "graph.energy",
                           "graph.momentum",
                           "fold.left",
                           "scene"})
    EXPECT_TRUE(all.contains(name)) << name;
}

TEST(PanelPicture, TheLayoutFitsAnyWindow) {
  for (const auto& [w, h] : {std::pair{320, 240}, {640, 480}, {1280, 720}, {1920, 1080}, {3840, 2160}}) {
    const ScreenRect rect = PanelPicture::scene_rect(w, h);
    EXPECT_GE(rect.x, 0);
    EXPECT_GE(rect.width, 1);
    EXPECT_GE(rect.height, 1);
    EXPECT_LE(rect.x + rect.width, static_cast<float>(w));
    EXPECT_LE(rect.height, static_cast<float>(h));
    EXPECT_TRUE(w < 1280 || rect.width > 0.4f * static_cast<float>(w));
  }
}

/// Twenty bars of 2 ms in the colour of faint text, one of `high` ms, and a mark at 1.5 ms.
Image bars_with(float high, const char* mark = "") {
  GuiPass gui(13);
  WindowFrame frame(400, 200);
  gui.begin(400, 200);
  apply_theme(Theme::dark, ImGui::GetFontSize());
  StackedBars bars;
  bars.names = {"a"};
  bars.colors = {ImGui::GetColorU32(ImGuiCol_TextDisabled)};
  for (int k = 0; k < 20; ++k) {
    bars.parts.push_back({k == 5 ? high : 2});
    bars.line.push_back(std::numeric_limits<float>::quiet_NaN());
  }
  bars.marks = {{1.5f, mark}};
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize({400, 200});
  ImGui::Begin("plot", nullptr, ImGuiWindowFlags_NoDecoration);
  plot_stacked("bars", 380, 180, bars);
  ImGui::End();
  gui.end(frame.target());
  return frame.read();
}

int light_pixels(const Image& image) {
  int light = 0;
  for (std::size_t at = 0; at + 3 < image.rgba.size(); at += 4)
    light += image.rgba[at] > 190 && image.rgba[at + 1] > 190 && image.rgba[at + 2] > 190;
  return light;
}

TEST(PanelPicture, ABarThatIsCutIsMarked) {
  test_context();
  EXPECT_EQ(stacked_axis({1, 4}), 4) << "both fit";
  EXPECT_EQ(stacked_axis({2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 50}), 3) << "nine in ten fit";
  EXPECT_GT(light_pixels(bars_with(50)), light_pixels(bars_with(3)) + 5) << "3 ms is the axis";
}

TEST(PanelPicture, AMarkIsReadableOnABar) {
  test_context();
  // Digits in the colour of the bars would be invisible, and the pictures equal.
  EXPECT_FALSE(bars_with(2, "60 Hz") == bars_with(2, "88 Hz"));
}

}  // namespace
}  // namespace collidoscope

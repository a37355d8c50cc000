// Tests pictures of the panels against goldens. The viewer draws the panels with the same function.
// More than 400 lines: each panel has its own picture.

#include "headless/pictures/panel_picture.h"

#include <gtest/gtest.h>
#include <imgui.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <limits>
#include <ranges>
#include <set>

#include "sim_cuda/accuracy/record.h"
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

/// A recorded study: a hundred spheres of the Box Collider.
AccuracyView stored_study() {
  const std::string file = golden_file<"accuracy_study.json">().string();
  std::ifstream stream(file);
  const AccuracyRecord record = parse_record({std::istreambuf_iterator<char>(stream), {}}, file);
  AccuracyView panel_view;
  panel_view.points = record.points;
  mark_front(panel_view.points);
  panel_view.reference = record.reference;
  panel_view.executor = record.executor;
  panel_view.done = 1;
  panel_view.seconds = record.reference.seconds;
  for (const AccuracyPoint& point : panel_view.points)
    if (point.name == "1/30 s, 4 substeps" && point.series_name == "soft_step f32")
      panel_view.now = point.setting;
  return panel_view;
}

/// The accuracy panel with this study.
struct AccuracyPanel : SinglePanel {
  AccuracyPanel() : SinglePanel(draw_accuracy_panel, 338, 470) {
    workspace.visible_panels.accuracy = true;
    allow(0.1);
    view.accuracy = &panel_view;
  }
  void allow(double tolerance) {
    workspace.accuracy.tolerance = tolerance;
    panel_view.cheapest = cheapest_below(panel_view.points, tolerance);
  }
  ImVec2 place_of(std::size_t point) const {
    for (const AccuracyPlace& place : workspace.accuracy.places)
      if (place.point == point) return {place.x, place.y};
    ADD_FAILURE() << "no point " << point;
    return {-1, -1};
  }
  ImVec2 line() const {
    return workspace.accuracy.line ? ImVec2{workspace.accuracy.line->x, workspace.accuracy.line->y}
                                   : ImVec2{-1, -1};
  }
  AccuracyView panel_view = stored_study();
};

TEST(PanelPicture, Accuracy) {
  test_context();
  {
    AccuracyPanel dark;
    EXPECT_TRUE(looks_like_golden<"accuracy_dark">(dark.picture()));
  }
  AccuracyPanel light;
  light.workspace.theme = Theme::light;
  light.picture();
  light.pointer = light.place_of(*light.panel_view.cheapest);
  EXPECT_TRUE(looks_like_golden<"accuracy_light">(light.picture()));
}

TEST(PanelPicture, APointOfTheDiagramIsASetting) {
  test_context();
  AccuracyPanel panel;
  panel.picture();
  const std::vector<AccuracyPoint>& points = panel.panel_view.points;
  const auto slowest = std::ranges::max_element(
      points, {}, [](const AccuracyPoint& point) { return point.on_front ? point.ms.median : 0; });
  const auto fine = static_cast<std::size_t>(slowest - points.begin());
  const AccuracySetting& setting = panel.panel_view.points[fine].setting;
  panel.mouse(panel.place_of(fine), false);
  EXPECT_NE(panel.workspace.settings.physics.time_step, setting.time_step)
      << "the pointer alone changes nothing";
  panel.mouse(panel.pointer, true);
  panel.mouse(panel.pointer, false);
  const Settings& request = panel.workspace.settings;
  EXPECT_EQ(request.physics.time_step, setting.time_step);
  EXPECT_EQ(request.physics.substeps, setting.substeps);
  EXPECT_EQ(request.physics.iterations, setting.iterations);
  EXPECT_EQ(request.physics.solver, setting.solver);
  EXPECT_EQ(request.physics.integrator, setting.integrator);
  EXPECT_EQ(request.physics.rotation_update, setting.rotation_update);
  EXPECT_EQ(request.physics.precision, setting.precision);
  ASSERT_TRUE(request.physics.effects);
  EXPECT_EQ(request.physics.effects->continuous_collision, setting.continuous_collision);
}

TEST(PanelPicture, TheErrorThatIsAllowedIsALineToDrag) {
  test_context();
  AccuracyPanel panel;
  panel.picture();
  const ImVec2 line = panel.line();
  panel.mouse(line, false);
  panel.mouse(line, true);
  panel.mouse({line.x - 100, line.y + 40}, true);
  const double dragged = panel.workspace.accuracy.tolerance;
  EXPECT_LT(dragged, 0.05) << "less is below";
  panel.mouse({line.x, line.y + 40}, false);
  panel.mouse(line, false);
  EXPECT_EQ(panel.workspace.accuracy.tolerance, dragged) << "let go, it stays";
  // A click beside the line and all points has no effect.
  panel.mouse({line.x - 4, line.y - 30}, true);
  panel.mouse({line.x - 4, line.y - 60}, true);
  panel.mouse({line.x - 4, line.y - 60}, false);
  EXPECT_EQ(panel.workspace.accuracy.tolerance, dragged);
  // The line stops at a tenth of the smallest error.
  panel.allow(dragged);
  panel.picture();
  panel.mouse(panel.line(), true);
  for (int k = 0; k < 100; ++k) panel.mouse({line.x, 5000}, true);
  double least = 1;
  for (const AccuracyPoint& p : panel.panel_view.points)
    if (p.error > 0 && p.has_cost()) least = std::min(least, p.error);
  EXPECT_NEAR(panel.workspace.accuracy.tolerance, 0.1 * least, 1e-9 * least);
  panel.mouse({-1, -1}, false);
}

/// Cases and results of every kind.
HardCasesView hard_cases() {
  HardCasesView panel_view;
  panel_view.executor = "the CPU";
  panel_view.scene_before = "Box Collider";
  using enum TestStatus;
  const auto add = [&](const char* name, const char* group, std::array<TestStatus, 6> marks) {
    HardCaseView& one = panel_view.cases.emplace_back();
    one.name = name;
    one.what = "a sphere of 1 t lies on one of 1 kg for ten seconds";
    one.group = group;
    for (std::size_t k = 0; k < marks.size(); ++k) {
      TestRunView& test_run = one.test_runs.emplace_back();
      test_run.solver = static_cast<Solver>(k / 2);
      test_run.precision = k % 2 == 0 ? Precision::f32 : Precision::f64;
      test_run.status = marks[k];
      test_run.progress = 0.4;
      test_run.steps = 300;
    }
  };
  add("heavy_on_light_1e3", "mass ratios", {failed, expected_failure, passed, passed, passed, passed});
  add("light_on_heavy_1e6", "mass ratios", {passed, passed, passed, passed, passed, passed});
  add("stack_10", "stacks", {expected_failure, expected_failure, passed, passed, passed, passed});
  add("stack_50", "stacks", {expected_failure, expected_failure, passed, passed, passed, failed});
  add("stack_100_of_growing_spheres", "stacks",
      {expected_failure, expected_failure, passed, passed, running, waiting});
  add("coincident_centres", "overlap", {waiting, waiting, waiting, waiting, waiting, waiting});
  add("hundreds_in_one_point", "overlap", {waiting, waiting, waiting, waiting, waiting, waiting});
  add("joint_loop", "joints", {not_applicable, not_applicable, not_run, not_run, not_run, not_run});
  add("radius_zero", "bad input", {passed, passed, passed, passed, passed, passed});
  panel_view.cases.back().test_runs.resize(1);
  panel_view.cases.back().refused = true;
  TestRunView& failing = panel_view.cases[0].test_runs[0];
  failing.assertions = {{"no body that is not finite", "0", true, 300, std::nullopt},
                        {"penetration at most 0.01 m, states 60 to 300", "0.0123 m", false, 130, 1}};
  failing.failed_state = 130;
  failing.body = 1;
  TestRunView& limit = panel_view.cases[0].test_runs[1];
  limit.why = "the paper's impulses have no memory: what is light sinks in";
  limit.failure = "penetration at most 0.01 m, states 60 to 300: 0.0151 m at state 170, body 1";
  panel_view.shown = 0;
  panel_view.shown_test_run = 0;
  panel_view.current_task = "stack_100_of_growing_spheres, jacobi_split f32";
  return panel_view;
}

struct HardCasesPanel : SinglePanel {
  explicit HardCasesPanel(Theme theme) : SinglePanel(draw_hard_cases_panel, 338, 450) {
    workspace.theme = theme;
    workspace.visible_panels.hard_cases = true;
    workspace.hard_cases.selected = "heavy_on_light_1e3";
    view.hard_cases = &panel_view;
    view.with_times = false;
  }
  ImVec2 middle(const std::string& name) const {
    for (const auto& [widget, rect] : workspace.widgets)
      if (widget == name) return {rect.x + 0.5f * rect.width, rect.y + 0.5f * rect.height};
    ADD_FAILURE() << "no widget " << name;
    return {-1, -1};
  }
  void click(const std::string& name) {
    const ImVec2 at = middle(name);
    mouse(at, false);
    mouse(at, true);
    mouse(at, false);
  }
  HardCasesView panel_view = hard_cases();
};

TEST(PanelPicture, HardCases) {
  test_context();
  {
    HardCasesPanel dark(Theme::dark);
    EXPECT_TRUE(looks_like_golden<"hard_cases_dark">(dark.picture()));
  }
  HardCasesPanel light(Theme::light);
  light.picture();
  light.pointer = light.middle("hard_cases.mark.heavy_on_light_1e3.impulse f32");
  EXPECT_TRUE(looks_like_golden<"hard_cases_light">(light.picture()));
}

TEST(PanelPicture, ACaseAndEachOfItsMarksCanBeOpened) {
  test_context();
  HardCasesPanel panel(Theme::dark);
  panel.picture();
  HardCasesRequests& requests = panel.workspace.hard_cases;
  panel.click("hard_cases.case.stack_10");
  EXPECT_EQ(requests.selected, "stack_10");
  ASSERT_TRUE(requests.open);
  EXPECT_EQ(requests.open->which, 2u);
  EXPECT_FALSE(requests.open->test_run);
  panel.click("hard_cases.mark.stack_50.jacobi_split f64");
  EXPECT_EQ(requests.selected, "stack_50");
  EXPECT_EQ(requests.open->which, 3u);
  EXPECT_EQ(requests.open->test_run, 5u);
  // A case that cannot be opened is selected.
  requests.open.reset();
  panel.click("hard_cases.case.radius_zero");
  EXPECT_EQ(requests.selected, "radius_zero");
  panel.click("hard_cases.mark.radius_zero");
  panel.click("hard_cases.mark.joint_loop.impulse f32");
  EXPECT_FALSE(requests.open);
  panel.click("hard_cases.run");
  EXPECT_TRUE(requests.run_selected);
  panel.click("hard_cases.run_all");
  EXPECT_TRUE(requests.stop) << "something runs";
  EXPECT_FALSE(requests.run_all);
  panel.panel_view.current_task.clear();
  panel.click("hard_cases.run_all");
  EXPECT_TRUE(requests.run_all);
  panel.click("hard_cases.back");
  EXPECT_TRUE(requests.back);
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

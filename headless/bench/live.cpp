#include "headless/bench/live.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "headless/cli/progress.h"
#include "headless/cli/standard_output.h"
#include "headless/pictures/egl_context.h"
#include "headless/reporting/percentiles.h"
#include "headless/reporting/percentiles_json.h"
#include "headless/reporting/report.h"
#include "headless/reporting/result_files.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/core/wall_clock.h"
#include "viewer/render/gui_pass.h"
#include "viewer/render/window_frame.h"
#include "viewer/view/drawing_pause.h"
#include "viewer/view/scene_view.h"
#include "viewer/view/simulation_thread.h"

namespace collidoscope {
namespace {

using Json = nlohmann::ordered_json;
using LiveClock = std::chrono::steady_clock;

void log_line(const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); }

/// The viewer's loop without a window and without input: the same thread, view and panels.
class WindowLoop {
 public:
  WindowLoop(const Scene& scene, const Options& options)
      : live_(scene, options.run),
        context_(options.capture.drawing_gpu(live_.world().info().gpu)),
        width_(options.capture.width),
        height_(options.capture.height),
        font_size_(workspace_font_size(width_, height_, 1)),
        gui_(font_size_),
        picture_(width_, height_),
        view_(options.capture.display_path, options.capture.draw, log_line),
        thread_(live_, breaks_, {}) {
    for (const std::string& line : context_.steps_down()) log_line(line);
    workspace_.layers = window_layers(options.capture.layers);
    workspace_.settings = live_.settings();
    plan_.speed = 1e9;  // as fast as possible
    plan_.request.layers = workspace_.layers;
    plan_.request.exact_levels = false;
    publish_state(live_, plan_.request, nullptr, *state_);
  }

  /// Simulates and draws for this time. Returns the steps, and the time that they took.
  std::int64_t run(double duration, double& seconds) {
    const LiveClock::time_point start = LiveClock::now();
    thread_.start(plan_);
    while (seconds_since(start) < duration) frame();
    thread_.pause(std::chrono::minutes(10));
    seconds = seconds_since(start);
    const SimulationThread::Result result = thread_.take_result();
    if (result.error) std::rethrow_exception(result.error);
    return result.steps;
  }

  LiveWorld& live() { return live_; }
  const EglContext& context() const { return context_; }
  const std::string& display_path() const { return view_.display_path(); }
  std::vector<float> frame_ms;  ///< time from frame to frame
  std::int64_t states_drawn = 0;

 private:
  void frame() {
    constexpr double shortest = 1.0 / 60;  // s, as on a usual display
    const LiveClock::time_point start = LiveClock::now();
    const bool news = view_.is_drawing() || thread_.take(state_);
    states_drawn += !view_.is_drawing() && news;
    gui_.begin(width_, height_);
    const ScreenRect rect =
        scene_view_rect(workspace_, static_cast<float>(width_), static_cast<float>(height_), font_size_);
    view_.draw(*state_, workspace_, tree_, static_cast<int>(rect.width), static_cast<int>(rect.height));
    picture_.place(view_.renderer(), static_cast<int>(rect.x), static_cast<int>(rect.y),
                   static_cast<int>(rect.width), static_cast<int>(rect.height));
    if (!view_.is_drawing()) {
      panels_ = state_->view;
      history_ = state_->history;
    }
    panels_.history = &history_;
    draw_workspace(workspace_, panels_);
    gui_.end(picture_.target());
    Renderer::finish();
    const double drawn = seconds_since(start);
    const bool waits = context_.software() && thread_.behind();
    const double pause = std::max(waits ? drawing_pause(drawn, news) : 0, shortest - drawn);
    std::this_thread::sleep_for(std::chrono::duration<double>(std::max(pause, 0.0)));
    frame_ms.push_back(static_cast<float>(1e3 * seconds_since(start)));
  }

  LiveWorld live_;
  EglContext context_;
  int width_, height_;
  float font_size_;
  GuiPass gui_;
  WindowFrame picture_;
  SceneView view_;
  TreeInspector tree_;
  Workspace workspace_;
  WorkspaceView panels_;
  History history_;
  std::unique_ptr<PublishedState> state_ = std::make_unique<PublishedState>();
  LiveBreakpoints breaks_;
  SimulationThread::Plan plan_;
  SimulationThread thread_;
};

struct LiveCost {
  std::vector<float> share;  ///< step rate with the window over the step rate without it
  std::vector<float> steps_per_second, plain_steps_per_second;
};

/// Each round simulates with the window, and then the same steps without it.
LiveCost measure_live(WindowLoop& window, World& plain, std::int64_t rounds) {
  constexpr double round_seconds = 4;
  LiveCost cost;
  Progress progress("rounds", rounds);
  for (std::int64_t round = -1; round < rounds; ++round) {  // the first one warms up
    plain.restore(window.live().world());
    double seconds = 0;
    const std::int64_t steps = window.run(round_seconds, seconds);
    const LiveClock::time_point start = LiveClock::now();
    for (std::int64_t k = 0; k < steps; ++k) plain.step();
    const double plain_seconds = seconds_since(start);
    if (plain.state_hash() != window.live().state_hash())
      throw MachineError("bench live: the window reached another state than the run without it");
    if (round < 0) {
      window.frame_ms.clear();
      window.states_drawn = 0;
      continue;
    }
    cost.share.push_back(static_cast<float>(plain_seconds / seconds));
    cost.steps_per_second.push_back(static_cast<float>(static_cast<double>(steps) / seconds));
    cost.plain_steps_per_second.push_back(static_cast<float>(static_cast<double>(steps) / plain_seconds));
    progress.update(round + 1);
  }
  return cost;
}

}  // namespace

int bench_live(const CommandLine& line) {
  const ResultFiles files(line.options);
  const Scene scene = load_scene(line);
  WindowLoop window(scene, line.options);
  World plain(scene, line.options.run);
  const LiveCost cost =
      measure_live(window, plain, line.options.bench.repeats_given ? line.options.bench.repeats : 7);
  const Percentiles share = percentiles_of(cost.share), with = percentiles_of(cost.steps_per_second),
                    without = percentiles_of(cost.plain_steps_per_second),
                    frame = percentiles_of(window.frame_ms);
  double sum = 0;
  for (const float ms : window.frame_ms) sum += static_cast<double>(ms);
  const double frames_per_second = 1e3 * static_cast<double>(window.frame_ms.size()) / sum,
               states_per_second = 1e3 * static_cast<double>(window.states_drawn) / sum;
  const Json json{{"suite", "live"},
                  {"physics_version", physics_version},
                  {"device", plain.info().device_name},
                  {"renderer", window.context().renderer()},
                  {"display_path", window.display_path()},
                  {"width", line.options.capture.width},
                  {"height", line.options.capture.height},
                  {"scene", scene.name},
                  {"bodies", plain.initial().size()},
                  {"rounds", cost.share.size()},
                  {"share", percentiles_json(share)},
                  {"steps_per_second", percentiles_json(with)},
                  {"steps_per_second_without_window", percentiles_json(without)},
                  {"frames_per_second", frames_per_second},
                  {"states_drawn_per_second", states_per_second},
                  {"frame_ms", percentiles_json(frame)}};
  files.write(json_text(json), "", "");
  print(line.options.json == "-"
            ? json_text(json)
            : fmt::format(
                  "{}, {} bodies on {}, drawn at {}x{} by {} ({})\n"
                  "  {:.2f} steps per second with the window, {:.2f} without: {:.1f} % ({:.1f} to {:.1f})\n"
                  "  {:.1f} frames per second, 95th percentile {:.1f} ms; {:.1f} states per second drawn\n",
                  scene.name, plain.initial().size(), plain.info().device_name, line.options.capture.width,
                  line.options.capture.height, window.context().renderer(), window.display_path(),
                  with.median, without.median, 100 * share.median, 100 * share.p5, 100 * share.p95,
                  frames_per_second, frame.p95, states_per_second));
  return 0;
}

}  // namespace collidoscope

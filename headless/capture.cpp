#include "headless/capture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "headless/cli/output_file.h"
#include "headless/cli/progress.h"
#include "headless/cli/standard_output.h"
#include "headless/pictures/egl_context.h"
#include "headless/pictures/panel_picture.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/recording/series.h"
#include "ui/chart.h"
#include "ui/overlay.h"
#include "viewer/render/gl/target.h"
#include "viewer/render/gui_pass.h"
#include "viewer/render/interop/display_link.h"
#include "viewer/render/legend.h"
#include "viewer/render/renderer.h"
#include "viewer/render/value_range.h"
#include "viewer/session/live_reference.h"

namespace collidoscope {
namespace {

std::string variant_name(const Scene& scene) {
  if (scene.generators.empty()) return "";
  switch (scene.generators[0].variant) {
    case Variant::paper:
      return "paper";
    case Variant::scaled:
      return "scaled";
    case Variant::settled:
      return "settled";
    case Variant::equal:
      return "equal";
  }
  return "";
}

OverlayText overlay_text(World& world, const CaptureRequest& request, const Renderer& renderer,
                         const PublishCounts& drawn, const StepStats& stats, const ValueRange& values,
                         const ReferenceView& reference) {
  OverlayText text;
  const FrameLayers& layers = request.layers;
  text.scene = world.scene().name;
  text.state = stats.step;
  text.time = world.time();
  text.bodies = stats.bodies;
  text.shape = world.launch_shape();
  text.variant = variant_name(world.scene());
  const WorldInfo info = world.info();
  text.executor = info.on_gpu ? "CUDA" : "CPU";
  text.device = info.device_name;
  text.pairs = stats.pairs;
  if (const auto check = world.pair_check()) text.pairs_note = short_note_of(*check);
  text.touching = stats.touching;
  text.speculative = stats.speculative;
  const RunTimes times = world.times();
  text.stages = times.stages;
  text.step_ms = times.step_median_ms;
  text.timings = request.timings;
  if (layers.spheres) text.body_colors = body_legend(layers.color, values, stats);
  if (layers.boxes) text.box_colors = box_legend(layers.box_color, values);
  text.boxes_drawn = layers.box_color == NodeMetric::level ? drawn.boxes : values.boxes;
  if (layers.boxes && layers.box_color == NodeMetric::level) {
    const int last = std::min(layers.last_level, static_cast<int>(world.tree().level_sizes().size()) - 1);
    const std::vector<std::uint32_t> colors = level_legend(layers.first_level, last);
    for (int level = layers.first_level; level <= last; ++level)
      text.levels.push_back({level, colors[static_cast<std::size_t>(std::min(level, max_levels - 1))]});
  }
  text.contacts_shown = layers.contacts;
  text.contact_colors = contact_legend();
  text.max_impulse = values.max_impulse;
  if (reference.known() && layers.ghosts) text.keys.push_back({"ghosts: " + reference.name, ghost_legend()});
  if (reference.known() && layers.errors)
    text.keys.push_back({fmt::format("errors × {}", short_number(values.error_scale)), error_legend()});
  if (layers.grid) text.grid_spacing = renderer.scene().grid_spacing;
  return text;
}

}  // namespace

std::string file_stem(const std::string& scene) {
  std::string stem;
  for (char c : scene) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) || c == '-';
    if (plain) stem += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (!plain && !stem.empty() && stem.back() != '_') stem += '_';
  }
  while (!stem.empty() && stem.back() == '_') stem.pop_back();
  return stem.empty() ? "scene" : stem;
}

std::vector<std::int64_t> states_to_draw(const CaptureRequest& request, std::int64_t first) {
  return request.states.empty() ? std::vector{first, first + 30, first + 60} : request.states;
}

std::string picture_file(const CaptureRequest& request, const Scene& scene, std::int64_t state) {
  return (std::filesystem::path(request.out) / fmt::format("{}_{:04}.png", file_stem(scene.name), state))
      .string();
}

int run_capture(const CaptureRequest& request, World& world, const std::vector<BodyTable>& frames) {
  ensure_writable_folder("--out", request.out);
  const std::vector<std::int64_t> states = states_to_draw(request, world.steps());
  if (states.front() < world.steps())
    throw InputError(fmt::format("--states: {} is before the first state; expected at least {}",
                                 states.front(), world.steps()));
  if (!frames.empty() && states.back() >= std::ssize(frames))
    throw InputError(
        fmt::format("--states: {} is after the last frame, {}", states.back(), frames.size() - 1));
  const auto log = [](const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); };
  const EglContext context(request.drawing_gpu(world.info().gpu));
  for (const std::string& line : context.steps_down()) log(line);

  int width = request.width, height = request.height;  // of the 3D view
  if (request.layers.ui) {
    const ScreenRect rect = PanelPicture::scene_rect(width, height);
    width = static_cast<int>(rect.width);
    height = static_cast<int>(rect.height);
  }
  Renderer renderer(width, height,
                    still_options(request.draw, request.width, request.height, gl::largest_target()));
  renderer.set_scene(frame_scene(world.scene(), world.initial()));
  DisplayLink link(world.info(), request.display_path, log);
  GuiPass gui(request.layers.ui ? workspace_font_size(request.width, request.height, 1)
                                : overlay_font_size(request.width, request.height));
  log(fmt::format("renderer: {}{}, OpenGL {}; display path: {}", context.renderer(),
                  context.software() ? " (software renderer)" : "", context.version(),
                  display_path_name(link.path())));
  std::optional<PanelPicture> panels;
  if (request.layers.ui) {
    panels.emplace(world, request.layers, request.width, request.height, request.timings);
    panels->set_renderer(context.renderer(), context.software(), display_path_name(link.path()));
  }
  const double aspect = static_cast<double>(width) / height;
  const OrbitCamera camera = scene_camera(world.scene().camera, renderer.scene().bounds, aspect);

  world.records().record_impulses(request.layers.contacts);
  world.records().record_residuals(request.layers.convergence);
  LiveReference reference;
  const bool asked = request.layers.needs_reference();
  if (asked) reference.follow(world, 0);
  const double time_step = world.scene().physics.time_step;
  Progress progress("capture", states.back());
  for (std::int64_t state : states) {
    if (!frames.empty()) go_to_frame(world, frames, static_cast<std::size_t>(state));
    while (world.steps() < state) {
      if (asked) reference.advance_to_next_step(time_step, std::numeric_limits<double>::infinity());
      world.step();
      if (world.validation().paused()) {
        log(describe(*world.validation().finding()));
        return 1;
      }
      reference.stepped(time_step);
      if (panels) panels->record(world);
      progress.update(world.steps());
    }
    const StepStats stats = world.measure();
    if (asked) renderer.set_ghosts(reference.ghosts(world, 0));
    if (panels) panels->refresh(world, renderer, reference.view());
    link.publish(world, request.layers, renderer.instances());
    const ValueRange values = value_range(world, renderer.scene(), request.layers, stats);
    renderer.draw(camera, request.layers, values);
    const PublishCounts drawn = renderer.instances().counts;
    Image picture;
    if (panels) {
      picture = panels->draw(gui, world, stats, renderer, values);
    } else if (request.layers.overlay) {
      gui.begin(request.width, request.height);
      draw_overlay(overlay_text(world, request, renderer, drawn, stats, values, reference.view()),
                   static_cast<float>(request.width), static_cast<float>(request.height));
      gui.end(renderer.picture());
    }
    const std::string file = picture_file(request, world.scene(), state);
    write_png(panels ? picture : renderer.read_picture(), file);
    print(fmt::format("{}  {}x{}  state {}  bodies {}  boxes drawn {}  touching {}\n", file, request.width,
                      request.height, state, stats.bodies,
                      request.layers.box_color == NodeMetric::level ? drawn.boxes : values.boxes,
                      stats.touching));
    if (const ReferenceView& view = reference.view(); view.known())
      print(fmt::format(
          "{:{}}  error {:.3g} m rms, {:.3g} m max; reference: {}, from state {}, {}\n", "", file.size(),
          view.rms, view.max, view.name, view.start_state,
          view.error_estimate > 0 ? fmt::format("its own error {:.2g} m", view.error_estimate) : "exact"));
    else if (asked)
      log(fmt::format("state {}: no reference: {}", state, reference.view().unavailable_reason));
    flush_stdout();
  }
  return 0;
}

}  // namespace collidoscope

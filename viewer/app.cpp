#include "viewer/app.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "headless/cli/tuned_option.h"
#include "sim_cuda/core/atomic_file.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/recording/series.h"
#include "sim_cuda/scene/body_count.h"
#include "sim_cuda/scene/box_collider.h"
#include "ui/colored_levels.h"
#include "ui/widgets.h"
#include "viewer/app_error_bar.h"
#include "viewer/render/gl/errors.h"
#include "viewer/session/fill_view.h"
#include "viewer/session/settings_file.h"
#include "viewer/view/drawing_pause.h"

namespace collidoscope {
namespace {

void log_to_stderr(const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); }

/// Workspace from the settings file, overridden by the command line. `keeps`: whether the file may be written
/// at exit.
Workspace first_workspace(const Options& options, bool& keeps) {
  Workspace workspace;
  const std::string file = settings_path();
  keeps = !file.empty();
  if (!options.view.reset_ui && keeps) {
    const RememberedSettings remembered = read_settings_file(file, workspace);
    if (!remembered.fault.empty()) log_to_stderr(remembered.fault);
    keeps = remembered.may_be_written;
  }
  const FrameLayers& asked = options.capture.layers;
  if (!(asked == CaptureRequest{}.layers)) workspace.layers = window_layers(asked);
  workspace.levels_chosen |= workspace.layers.boxes;
  if (options.breaks.any()) {
    workspace.breaks.set_conditions(options.breaks);
    workspace.visible_panels.right = workspace.visible_panels.breaks = true;
  }
  return workspace;
}

std::optional<Automation> automation_of(const Options& options) {
  if (options.view.automation.empty()) return std::nullopt;
  try {
    return Automation(options.view.automation);
  } catch (const InputError& error) {
    throw InputError(std::string("--automation: ") + error.what());
  }
}

}  // namespace

App::App(const Start& start, const Options& options)
    : options_(options),
      automation_(automation_of(options)),
      window_(options.capture.width, options.capture.height, "Collidoscope · " + start.scene.name),
      gui_(workspace_font_size(window_.width(), window_.height(), 1, window_.content_scale())),
      input_(window_),
      picture_(std::max(window_.width(), 1), std::max(window_.height(), 1)),
      live_(make_world(start)),
      scene_(options.capture.display_path, options.capture.draw, log_to_stderr),
      stability_(options.stability.cases, options.run),
      workspace_(first_workspace(options, keeps_settings_)),
      renderer_name_(gl::renderer_name()),
      software_(gl::is_software_renderer()),
      simulation_(live_, breaks_, [] { Window::wake(); }) {
  cuda_available(&cuda_unavailable_reason_);
  if (start.recording) live_.take_recording(read_run(*start.recording));
  workspace_.settings = known_settings_ = live_.settings();
  workspace_.has_timeline = true;
  if (!live_.world().initial().meshes.empty()) show_notice("mesh bodies collide as their bounding spheres");
  if (!start.frames.empty()) live_.take_recording(run_of_frames(live_.world(), start.frames));
  show_import(start);
}

/// Makes the world, which may take long. Shows a message meanwhile; closing the window cancels it.
World App::make_world(const Start& start) {
  if (Cancellation* const cancellation = options_.run.cancellation)
    cancellation->set_poll([this, cancellation] {
      window_.poll();
      if (window_.closing()) cancellation->request();
    });
  const std::int64_t bodies = bodies_of(start.scene);
  constexpr std::int64_t many = 20'000;
  if (bodies < many && !needs_presimulation(start.scene)) return start.world(options_.run);
  const std::string text = fmt::format("preparing {} bodies ...", grouped_number(bodies));
  constexpr float grey[] = {0.1f, 0.1f, 0.1f, 1};
  gui_.begin(picture_.width(), picture_.height());
  ImGui::GetForegroundDrawList()->AddText({20, 20}, IM_COL32_WHITE, text.c_str());
  glClearNamedFramebufferfv(picture_.target().framebuffer(), GL_COLOR, 0, grey);
  gui_.end(picture_.target());
  picture_.present(picture_.width(), picture_.height());
  window_.swap();
  return start.world(options_.run);
}

bool App::run(const std::function<bool()>& ended) {
  Clock::time_point last = Clock::now();
  while (!window_.closing() && !ended() && !cancelled_ && automation_failure_.empty()) {
    wait_for_events();
    const Clock::time_point now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - last).count();
    last = now;
    if (window_.width() == 0 || window_.height() == 0) {  // minimised: no drawing, no steps
      simulation_.pause(std::chrono::milliseconds(0));
      window_.poll(0.1);
      continue;
    }
    frame(std::min(seconds, 0.25));
    frame_seconds_ = std::chrono::duration<double>(Clock::now() - now).count();
  }
  end_steps();
  try {
    if (keeps_settings_) write_file_atomically(settings_path(), settings_text(workspace_));
  } catch (const MachineError& error) {
    log_to_stderr(error.what());
  }
  if (!automation_failure_.empty()) throw MachineError("--automation: " + automation_failure_);
  return cancelled_;
}

/// Waits until there is something to draw: an event, a new state, or work of a panel.
void App::wait_for_events() {
  bool busy = !window_.events().empty() || !buttons_.empty() || frame_ == 0;
  busy |= workspace_.step_requests > 0 && !work_in_progress_;
  window_.poll(busy || scene_.is_drawing() ? 0 : automation_ || workspace_.backwards ? 0.01 : 0.05);
  if (!software_ || busy || !(simulation_.behind() || slices_in_progress_)) return;
  const Clock::time_point until =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(
                         std::chrono::duration<double>(drawing_pause(frame_seconds_, has_news_)));
  for (Clock::time_point now; window_.events().empty() && !window_.closing() && (now = Clock::now()) < until;)
    window_.poll(std::max(std::chrono::duration<double>(until - now).count(), 1e-3));
}

/// Ends the present step, or cancels it if it takes long.
void App::end_steps() {
  using std::chrono::milliseconds;
  if (simulation_.pause(milliseconds(100))) return;
  if (options_.run.cancellation) options_.run.cancellation->request();
  while (!simulation_.pause(milliseconds(100))) window_.poll();
  try {
    if (const auto result = simulation_.take_result(); result.error) std::rethrow_exception(result.error);
  } catch (const Cancelled&) {
    cancelled_ = true;
  } catch (const std::exception& error) {
    log_to_stderr(error.what());
  }
}

/// Each part has its own error boundary. An error in one part does not stop the others.
void App::frame(double seconds) {
  const int width = window_.width(), height = window_.height();
  with_error_bar([&] {
    const float content_scale = window_.content_scale();
    const PanelVisibility& visible_panels = workspace_.visible_panels;
    workspace_.largest_font_scale = largest_font_scale(width, height, content_scale, visible_panels);
    gui_.set_font_size(
        workspace_font_size(width, height, workspace_.font_scale, content_scale, visible_panels));
  });
  std::vector<InputEvent> events;
  with_error_bar([&] { events = input_.feed(); });
  gui_.begin(width, height, static_cast<float>(std::max(seconds, 1e-4)));
  for (const InputEvent& event : events) with_error_bar([&] { handle(event); });
  with_error_bar([&] { fly_camera(seconds); });
  if (!workspace_.notice.empty() && Clock::now() - notice_since_ > std::chrono::seconds(5))
    workspace_.notice.clear();
  show_progress();
  // A picture shows the present layers, not those of a drawing in progress.
  if (workspace_.screenshot_requested) with_error_bar([&] { scene_.finish_drawing(); });
  // Short steps are waited for, so that requests are handled in this frame.
  constexpr std::chrono::milliseconds patience(8);
  publish_skipped_ = false;
  has_world_ = simulation_.paused() || (needs_world() && simulation_.pause(patience));
  if (has_world_) {
    use_world();
  } else {
    has_news_ = scene_.is_drawing();
    if (!has_news_ && simulation_.take(next_)) {
      has_news_ = true;
      follow_settings(next_->view.active_settings);
    }
    simulation_.update(plan());
  }
  if (cancelled_) return;

  const float font_size = ImGui::GetFontSize();
  const ScreenRect rect =
      scene_view_rect(workspace_, static_cast<float>(width), static_cast<float>(height), font_size);
  WorkspaceView view;
  with_error_bar([&] { picture_.resize(width, height); });
  with_error_bar([&] { draw_scene(rect); });
  with_error_bar([&] { fill(view); });
  if (cancelled_) return;

  const Clock::time_point before = Clock::now();
  if (!with_error_bar([&] { draw_workspace(workspace_, view); })) end_unfinished_panels(workspace_);
  double ui_ms = std::chrono::duration<double, std::milli>(Clock::now() - before).count();
  with_error_bar([&] { gui_.end(picture_.target()); });
  if (std::exchange(workspace_.screenshot_requested, false)) with_error_bar([&] { save_picture(); });
  with_error_bar([&] { picture_.present(width, height); });
  window_.swap();
  ++frame_;
  with_error_bar([&] { write_automation(view, ui_ms); });
}

/// Draws the next state. The panels show its values as soon as its picture is complete.
void App::draw_scene(const ScreenRect& rect) {
  if (!next_ || !next_->scene) return;  // publishing failed
  scene_.draw(*next_, workspace_, tree_, std::max(static_cast<int>(rect.width), 1),
              std::max(static_cast<int>(rect.height), 1));
  if (workspace_.screenshot_requested) scene_.finish_drawing();
  picture_.place(scene_.renderer(), static_cast<int>(rect.x), static_cast<int>(rect.y),
                 static_cast<int>(rect.width), static_cast<int>(rect.height));
  if (scene_.is_drawing()) return;
  run_ = next_->view;
  history_ = next_->history;
}

/// Contents of panels that the simulation thread changes.
void App::follow_panels() {
  if (workspace_.visible_panels.right && workspace_.visible_panels.effects) {
    effects_ = costs_.views(live_.world());
    measuring_effects_ = workspace_.measure_effects && !costs_.done();
  }
  if (shows_accuracy()) accuracy_view_ = accuracy_.view(live_.world(), workspace_.accuracy);
  if (shows_launch_map()) {
    launch_map_view_ = launch_map_.view(live_.world());
    if (const LaunchTuner* const tuner = launch_map_.take_complete())
      if (const std::string kept = keep_result(options_, nullptr, live_.world(), *tuner); !kept.empty())
        show_notice(kept);
    launch_map_view_.colors = value_legend();
  }
  if (shows_hard_cases()) hard_cases_view_ = stability_.view();
  reference_view_ = reference_.view();
}

void App::fill(WorkspaceView& view) {
  view = run_;
  view.history = &history_;
  if (workspace_.visible_panels.right && workspace_.visible_panels.effects) {
    view.effect_views = effects_;
    view.measuring_effects = measuring_effects_;
  }
  view.measuring = measuring_;
  if (shows_accuracy()) view.accuracy = &accuracy_view_;
  if (shows_launch_map()) view.launch_map = &launch_map_view_;
  if (shows_hard_cases()) view.hard_cases = &hard_cases_view_;
  view.reference = reference_view_;
  if (view.reference.name.empty())
    view.reference.unavailable_reason = LiveReference::unavailable_reason(view.stats.bodies);
  view.renderer = renderer_name_;
  view.software = software_;
  view.view_scale = scene_.scale();
  view.display_path = scene_.display_path();
  view.cuda_unavailable_reason = cuda_unavailable_reason_;
  view.contact_colors = contact_legend();
  view.orthographic = scene_.camera().orthographic;
  view.mark_colors = mark_legend();
  view.tree = tree_.view();
  if (scene_.selected()) view.selected = &*scene_.selected();
  const auto [first_level, last_level] =
      colored_levels(workspace_.layers, view.level_sizes.size(), view.selected);
  view.level_colors = level_legend(first_level, last_level);
  const ScreenRect rect = scene_view_rect(workspace_, static_cast<float>(window_.width()),
                                          static_cast<float>(window_.height()), ImGui::GetFontSize());
  for (const auto& [x, y] : scene_.outline())
    view.outline.emplace_back(static_cast<float>(x) + rect.x, static_cast<float>(y) + rect.y);

  view.faulty_pairs = scene_.faulty_pairs();
  for (WorkspaceView::FaultyPairView& pair : view.faulty_pairs)
    for (auto* around : {&pair.a, &pair.b})
      for (auto& [x, y] : *around) x += rect.x, y += rect.y;
  for (const auto& around : scene_.frozen_outlines()) {
    auto& points = view.frozen_outlines.emplace_back();
    for (const auto& [x, y] : around)
      points.emplace_back(static_cast<float>(x) + rect.x, static_cast<float>(y) + rect.y);
  }

  const Clock::time_point now = Clock::now();
  const double simulated = simulation_.simulated();
  moments_.push_back({now, simulated});
  while (moments_.size() > 2 && now - moments_.front().when > std::chrono::seconds(1)) moments_.pop_front();
  const double span = std::chrono::duration<double>(now - moments_.front().when).count();
  if (span > 0) {
    view.frames_per_second = static_cast<double>(moments_.size() - 1) / span;
    view.real_time_factor = (simulated - moments_.front().simulated) / span;
  }
}

void App::write_automation(const WorkspaceView& view, double ui_ms) {
  if (!automation_) return;
  Automation::Frame frame;
  frame.frame = frame_;
  frame.complete = !scene_.is_drawing() && (workspace_.playing || !publish_skipped_);
  frame.releases = input_.releases();
  frame.width = picture_.width();
  frame.height = picture_.height();
  with_error_bar([&] {
    // The hash of the shown state, not of a later one whose picture is not complete.
    if (!has_world_ || workspace_.playing || workspace_.state_request || scene_.is_drawing() || !next_)
      return;
    const PublishedState::Key& shown = next_->key;
    if (shown.generation == live_.generation() && shown.step == live_.world().steps())
      frame.state_hash = live_.state_hash();
  });
  const OrbitCamera& camera = scene_.camera();
  for (int axis = 0; axis < 3; ++axis) frame.camera[axis] = camera.target[axis];
  frame.camera[3] = camera.azimuth;
  frame.camera[4] = camera.elevation;
  frame.camera[5] = camera.distance;
  frame.ui_ms = ui_ms;
  frame.picture = picture_file_;
  frame.wants_mouse = ImGui::GetIO().WantCaptureMouse;
  frame.list_open = ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopup);
  if (scene_.has_renderer()) {
    const PublishCounts& drawn = scene_.renderer().instances().counts;
    frame.spheres = drawn.bodies;
    frame.boxes = drawn.boxes;
    frame.contacts = drawn.contacts;
  }
  try {
    automation_->write(frame, workspace_, view);
  } catch (const MachineError& error) {
    automation_failure_ = error.what();
  }
}

void App::report_error(const std::string& line, bool step) {
  if (step) {
    workspace_.playing = false;
    workspace_.step_requests = 0;
  }
  // Reports an error that repeats in each frame once.
  if (!workspace_.errors.empty() && workspace_.errors.back() == line) return;
  log_to_stderr(line);
  workspace_.errors.push_back(line);
}

}  // namespace collidoscope

// The simulation thread makes the steps. This file decides when the window uses the world itself.

#include <chrono>
#include <utility>

#include "viewer/app_error_bar.h"

namespace collidoscope {

/// Whether something is to be done that needs the world, or that changes it.
bool App::needs_world() const {
  const Workspace& w = workspace_;
  const PanelVisibility& panels = w.visible_panels;
  const bool requested =
      w.restart_requested || w.csv_requested || w.json_requested || w.changes_file_requested ||
      w.projectile_requested || w.removal_requested || w.state_request || w.step_requests > 0 ||
      w.reference_requested || w.tree.node || w.tree.rank || w.camera_request == CameraRequest::frame_all ||
      w.camera_request == CameraRequest::frame_selection || w.breaks.stop != StopRequest::none;
  const bool measured =
      panels.right && (panels.tree || panels.effects || panels.accuracy || panels.hard_cases);
  return !w.playing || requested || measured || w.adjusting_result || w.layers.needs_reference() ||
         presimulation_ || w.settings != known_settings_;
}

SimulationThread::Plan App::plan() const {
  const PanelVisibility& panels = workspace_.visible_panels;
  SimulationThread::Plan plan;
  plan.speed = workspace_.speed;
  plan.publishes = !workspace_.layers.needs_reference();  // the reference belongs to the window
  plan.pause_at = options_.view.pause_at;
  plan.conditions = workspace_.breaks.conditions();
  PublishRequest& request = plan.request;
  request.layers = workspace_.layers;
  request.selection = workspace_.selection;
  // Recorded only while they are shown.
  request.impulses = workspace_.layers.contacts || (workspace_.selection && panels.right && panels.inspector);
  request.residuals = panels.right && panels.convergence;
  request.exact_levels = !workspace_.playing;
  return plan;
}

/// The part of a frame in which the window has the world: handles requests, publishes the state, and lets the
/// run continue.
void App::use_world(double seconds) {
  with_error_bar([&] { handle_result(); }, true);
  if (cancelled_) return;
  with_error_bar([&] { follow_settings(); });
  handle_requests(seconds);
  if (cancelled_) return;
  with_error_bar([&] { tree_.refresh(live_.world(), live_.generation(), workspace_); });
  with_error_bar([&] { follow_panels(); });
  with_error_bar([&] { publish(); });
  with_error_bar([&] { follow_settings(); });
  if (cancelled_) return;
  with_error_bar([&] { continue_run(); }, true);
}

/// What the thread did until it paused.
void App::handle_result() {
  const SimulationThread::Result result = simulation_.take_result();
  if (result.steps > 0) reference_.stepped(result.simulated);
  if (!result.notice.empty()) show_notice(result.notice);
  if (result.stopped || result.reached) {
    workspace_.playing = false;
    workspace_.step_requests = 0;
  }
  if (result.stopped)
    if (const auto& stop = breaks_.stop(live_); stop && stop->body) workspace_.selection = stop->body;
  if (result.error) std::rethrow_exception(result.error);
}

/// A script or an earlier change can change the settings during a step. They replace the requested settings,
/// unless the user has just changed these.
void App::follow_settings() {
  Settings now = live_.settings();
  if (workspace_.settings == known_settings_) workspace_.settings = now;
  known_settings_ = std::move(now);
}

/// The thread has published another state.
void App::follow_next() {
  const Settings& now = next_->view.active_settings;
  if (workspace_.settings == known_settings_) workspace_.settings = now;
  known_settings_ = now;
}

void App::publish() {
  if (scene_.is_drawing()) return;  // the state must stay the same
  if (!next_) next_ = std::make_unique<PublishedState>();
  publish_state(live_, plan().request, &reference_, *next_);
  next_->view.stop = breaks_.stop(live_);
}

void App::continue_run() {
  const bool requested = workspace_.step_requests > 0;
  if (!requested && !workspace_.playing) return;
  if (is_blocked_by_stop()) return;
  // While such a slider is held the run waits: all its values act at one state and are recorded as one
  // change.
  if (workspace_.adjusting_result && !requested) return;
  constexpr double slice = 12;  // ms per frame
  const bool waits = workspace_.layers.needs_reference();
  if (waits && !reference_.advance_to_next_step(live_.world().scene().physics.time_step, slice)) return;
  if (requested) --workspace_.step_requests;
  has_world_ = false;
  SimulationThread::Plan next = plan();
  next.at_once = requested;
  simulation_.start(next, requested || waits ? 1 : std::numeric_limits<std::int64_t>::max());
}

}  // namespace collidoscope

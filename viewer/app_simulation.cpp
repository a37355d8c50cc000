// The simulation thread makes the steps. This file decides when the window uses the world itself.

#include <chrono>
#include <utility>

#include "viewer/app_error_bar.h"

namespace collidoscope {
namespace {

bool is_cancelled(const std::exception_ptr& error) try {
  std::rethrow_exception(error);
} catch (const Cancelled&) {
  return true;
} catch (...) {
  return false;
}

}  // namespace

/// Whether something is to be done that needs the world, or that changes it.
bool App::needs_world() const {
  const Workspace& w = workspace_;
  const PanelVisibility& panels = w.visible_panels;
  const bool requested =
      w.restart_requested || w.csv_requested || w.json_requested || w.changes_file_requested ||
      w.recording_requested || w.projectile_requested || w.removal_requested || w.state_request ||
      w.step_requests > 0 || w.other_run_requested || w.reference_requested || w.tree.node || w.tree.rank ||
      w.camera_request == CameraRequest::frame_all || w.camera_request == CameraRequest::frame_selection ||
      w.breaks.stop != StopRequest::none || !window_.dropped_files().empty() || w.columns.open ||
      w.columns_requested || w.plugin.confirmed;
  const bool measured = panels.right && (panels.tree || panels.effects || panels.accuracy ||
                                         panels.launch_map || panels.hard_cases);
  return !w.playing || requested || measured || w.adjusting_result || w.layers.needs_reference() ||
         slices_in_progress_ || w.settings != known_settings_;
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
void App::use_world() {
  handle_result();
  if (cancelled_) return;
  presimulating_ = measuring_ = false;
  with_error_bar([&] { follow_settings(live_.settings()); });
  handle_requests();
  if (cancelled_) return;
  with_error_bar([&] { tree_.refresh(live_.world(), live_.generation(), workspace_); });
  with_error_bar([&] { follow_panels(); });
  with_error_bar([&] { publish(); });
  with_error_bar([&] { follow_settings(live_.settings()); });
  if (cancelled_) return;
  with_error_bar([&] { continue_run(); }, true);
}

/// What the thread did until it paused.
void App::handle_result() {
  const SimulationThread::Result result = simulation_.take_result();
  if (result.steps > 0) reference_.stepped(result.simulated);
  if (std::exchange(step_in_progress_, false) && result.steps > 0 && workspace_.step_requests > 0)
    --workspace_.step_requests;
  if (!result.notice.empty()) show_notice(result.notice);
  if (result.stopped || result.reached) {
    workspace_.playing = false;
    workspace_.step_requests = 0;
  }
  if (result.stopped)
    if (const auto& stop = breaks_.stop(live_); stop && stop->body) workspace_.selection = stop->body;
  if (cancel_requested_ && options_.run.cancellation) options_.run.cancellation->clear();
  end_work(result);
  slices_in_progress_ = cancel_requested_ = false;
}

/// Ends the work in progress. Any error ends all requested changes.
void App::end_work(const SimulationThread::Result& result) {
  const bool ended = std::exchange(work_in_progress_, false);
  Work work;
  if (ended) {
    work = std::move(works_.front());
    works_.pop_front();
    workspace_.notice.clear();
  }
  if (!result.error) {
    if (ended) with_error_bar([&] { work.then(); });
    if (!cancel_requested_ || !presimulating_) return;
    show_notice("settling cancelled");
  } else if (!ended && !presimulating_ && cancel_requested_ && is_cancelled(result.error)) {
    return;  // a slice of a measurement
  }
  presimulation_.reset();
  workspace_.settings = live_.settings();
  workspace_.restart_requested = false;
  if (!result.error) return;
  try {
    std::rethrow_exception(result.error);
  } catch (const Cancelled&) {
    if (cancel_requested_)
      show_notice(ended ? "cancelled: " + work.what : "settling cancelled");
    else
      cancelled_ = true;
  } catch (...) {
    with_error_bar([&] { std::rethrow_exception(result.error); }, !ended);
  }
}

/// Whether a change of the world may take so long that the window must not wait for it.
bool App::is_slow_to_change() const {
  constexpr std::int64_t many = 20'000;
  constexpr double at_once = 0.05;  // s
  return live_.last_change_seconds() >= at_once ||
         std::max<std::int64_t>(std::ssize(live_.world().initial().radius),
                                workspace_.settings.generator.count) > many;
}

void App::change_world(Change change, const std::string& what) {
  const auto run = [this, change] { live_.apply(change); };
  const auto then = [this] {
    workspace_.settings = live_.settings();
    follow_selection();
  };
  if (is_slow_to_change()) return begin({what, run, then});
  run();
  then();
}

/// Shows what takes long.
void App::show_progress() {
  constexpr std::chrono::milliseconds patience(300);
  if (!work_in_progress_ || Clock::now() - work_since_ < patience) return;
  show_notice(works_.front().what + (options_.run.cancellation ? " ...; Esc: cancel" : " ..."));
}

void App::cancel_work() {
  cancel_requested_ = true;
  if (options_.run.cancellation) options_.run.cancellation->request_between_steps();
}

/// Ends the measurements of all panels. A step of a measurement is not completed.
void App::stop_measurements() {
  workspace_.measure_effects = workspace_.accuracy.running = workspace_.launch_map.running = false;
  workspace_.hard_cases.stop = true;
  show_notice("measurement stopped");
  if (slices_in_progress_) cancel_work();
}

/// A script or an earlier change can change the settings during a step. They replace the requested settings,
/// unless the user has just changed these.
void App::follow_settings(const Settings& now) {
  if (workspace_.settings == known_settings_) workspace_.settings = now;
  known_settings_ = now;
}

void App::publish() {
  publish_skipped_ = scene_.is_drawing();  // the state must stay the same
  if (publish_skipped_) return;
  if (!next_) next_ = std::make_unique<PublishedState>();
  publish_state(live_, plan().request, &reference_, *next_);
  next_->view.stop = breaks_.stop(live_);
}

void App::continue_run() {
  if (!works_.empty()) {
    has_world_ = false;
    work_in_progress_ = true;
    work_since_ = Clock::now();
    return simulation_.start(plan(), 0, [this] {
      works_.front().run();
      return false;
    });
  }
  const bool requested = workspace_.step_requests > 0;
  // While such a slider is held the run waits: all its values act at one state and are recorded as one
  // change.
  const bool steps = (requested || workspace_.playing) && !is_blocked_by_stop() &&
                     (!workspace_.adjusting_result || requested);
  if (!steps && slices_.empty()) return;
  SimulationThread::Plan next = plan();
  next.at_once = requested;
  const bool with_reference = steps && workspace_.layers.needs_reference();
  step_in_progress_ = steps && requested;
  const double time_step = live_.world().scene().physics.time_step;
  slices_in_progress_ = !slices_.empty() || with_reference;
  has_world_ = false;
  const auto before = [this, steps, with_reference, time_step, slices = std::exchange(slices_, {})] {
    bool more = true;
    while (more) {
      more = false;
      for (const auto& slice : slices) more |= slice();
      more = more && !steps && !simulation_.must_pause();
    }
    constexpr double slice_ms = 12;
    bool reached = true;
    if (with_reference) do
        reached = reference_.advance_to_next_step(time_step, slice_ms);
      while (!reached && !simulation_.must_pause());
    return steps && reached;
  };
  simulation_.start(next, requested || with_reference ? 1 : std::numeric_limits<std::int64_t>::max(), before);
}

}  // namespace collidoscope

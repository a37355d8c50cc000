// Handles the requests of panels and keys since the last frame.

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <utility>

#include "sim_cuda/core/atomic_file.h"
#include "sim_cuda/scene/box_collider.h"
#include "sim_cuda/scene/scene_file.h"
#include "ui/widgets.h"
#include "viewer/app_error_bar.h"
#include "viewer/render/image.h"
#include "viewer/session/projectile.h"
#include "viewer/unused_file_name.h"

namespace collidoscope {

void App::show_notice(const std::string& notice) {
  workspace_.notice = workspace_.last_notice = notice;
  notice_since_ = Clock::now();
}

void App::handle_requests() {
  if (std::exchange(workspace_.csv_requested, false)) with_error_bar([&] { export_history(true); });
  if (std::exchange(workspace_.json_requested, false)) with_error_bar([&] { export_history(false); });
  with_error_bar(
      [&] { scene_.handle_request(std::exchange(workspace_.camera_request, CameraRequest::none), live_); });
  with_error_bar([&] { apply_settings(); });
  if (std::exchange(workspace_.changes_file_requested, false)) with_error_bar([&] { export_changes(); });
  if (std::exchange(workspace_.recording_requested, false)) with_error_bar([&] { save_recording(); });
  if (std::exchange(workspace_.projectile_requested, false)) with_error_bar([&] { spawn_projectile(); });
  if (std::exchange(workspace_.removal_requested, false)) with_error_bar([&] { remove_selected(); });
  with_error_bar([&] { play_backwards(); });
  with_error_bar([&] { go_to_requested_state(); });
  const bool pending = workspace_.settings != live_.settings();
  if (std::exchange(workspace_.other_run_requested, false) && live_.other_run())
    begin({"opening the other run", [this] { live_.open_other_run(); },
           [this] { workspace_.settings = live_.settings(); }});
  if (workspace_.restart_requested && !pending) with_error_bar([&] { restart(); });
  if (!workspace_.restart_requested && !pending) presimulation_.reset();
  if (workspace_.selection && *workspace_.selection >= live_.world().initial().size())
    workspace_.selection.reset();
  with_error_bar([&] { handle_stop_request(); });
  with_error_bar([&] { follow_reference(); });
  with_error_bar([&] { measure_effects(); });
  with_error_bar([&] { measure_accuracy(); });
  with_error_bar([&] { measure_launch_map(); });
  with_error_bar([&] { follow_hard_cases(); });
  with_error_bar([&] { open_dropped_files(); });
  with_error_bar([&] { follow_columns(); });
  with_error_bar([&] { follow_plugin(); });
}

void App::go_to_requested_state() {
  const std::optional<std::int64_t> state = std::exchange(workspace_.state_request, std::nullopt);
  const Timeline& timeline = live_.timeline();
  if (!state || *state < timeline.first() || *state > timeline.last() || *state == live_.world().steps())
    return;
  workspace_.playing = false;
  begin({fmt::format("going to state {}", *state), [this, state] { live_.go_to(*state); },
         [this] { workspace_.settings = live_.settings(); }});
}

/// Requests the state that the requested speed calls for.
void App::play_backwards() {
  if (!workspace_.backwards) {
    went_back_ = Clock::now();
    return;
  }
  const std::int64_t now = live_.world().steps();
  if (now == live_.timeline().first()) {
    workspace_.backwards = false;
    return;
  }
  const double dt = live_.world().scene().physics.time_step;
  const double seconds = std::chrono::duration<double>(Clock::now() - went_back_).count();
  const double steps = workspace_.speed > 0 ? seconds * workspace_.speed / dt : 1;
  if (steps < 1) return;
  went_back_ = Clock::now();
  constexpr double most = 10;  // a slow machine does not skip more states
  workspace_.state_request =
      std::max(now - static_cast<std::int64_t>(std::min(steps, most)), live_.timeline().first());
}

void App::measure_effects() {
  const PanelVisibility& visible_panels = workspace_.visible_panels;
  if (!visible_panels.right || !visible_panels.effects) return;
  const bool another = costs_generation_ != live_.generation();
  if (another || (costs_.begun() && !workspace_.measure_effects)) costs_.begin(live_.world());
  costs_generation_ = live_.generation();
  constexpr double slice = 10;  // ms per frame
  if (!workspace_.measure_effects || costs_.done()) return;
  measuring_ = true;
  slices_.emplace_back([this] {
    costs_.advance(live_.world(), slice);
    return !costs_.done();
  });
}

void App::measure_accuracy() {
  if (!shows_accuracy()) return;
  accuracy_.follow(live_.world(), live_.generation(), workspace_.accuracy);
  if (!workspace_.accuracy.running || accuracy_.done()) return;
  constexpr double slice = 20;  // ms
  measuring_ = true;
  slices_.emplace_back([this] {
    accuracy_.advance(slice);
    return !accuracy_.done();
  });
}

void App::measure_launch_map() {
  if (!shows_launch_map()) return;
  launch_map_.follow(live_.generation(), workspace_.launch_map);
  if (!workspace_.launch_map.running || launch_map_.done()) return;
  constexpr double slice = 20;  // ms
  measuring_ = true;
  slices_.emplace_back([this, budget = workspace_.launch_map.budget] {
    launch_map_.advance(live_.world(), budget, slice);
    return !launch_map_.done();
  });
}

void App::follow_reference() {
  const bool requested = std::exchange(workspace_.reference_requested, false);
  if (!workspace_.layers.needs_reference() || requested) reference_.forget();
  if (workspace_.layers.needs_reference()) reference_.follow(live_.world(), live_.generation());
}

/// Whether a run of this scene can begin. If the scene needs pre-simulation, advances it; the present run
/// continues until it is done. Sets `rest` to the settled state.
bool App::finish_presimulation(const Scene& scene, std::optional<RunState>& rest) {
  if (!needs_presimulation(scene)) return true;
  std::string text = write_scene(scene);
  if (settling_scene_ != text) presimulation_.reset();
  settling_scene_ = std::move(text);
  if (presimulation_ && presimulation_->done()) {
    rest = presimulation_->take();
    presimulation_.reset();
    workspace_.notice.clear();
    return true;
  }
  if (presimulation_)
    show_notice(fmt::format("settling the bodies: step {} of at most {}; Esc: cancel",
                            presimulation_->steps(), presimulation_->max_steps()));
  presimulating_ = true;
  constexpr double slice = 30;  // ms
  slices_.emplace_back([this, scene, options = RunOptions(live_.world().options())] {
    if (!presimulation_) presimulation_.emplace(scene, options);
    presimulation_->advance(slice);
    return !presimulation_->done();
  });
  return false;
}

void App::restart() {
  std::optional<RunState> rest;
  if (!live_.scripted() && !finish_presimulation(live_.world().scene(), rest)) return;
  workspace_.restart_requested = false;
  const auto run = [this, rest] { live_.restart(rest ? &*rest : nullptr); };
  const auto then = [this] { workspace_.settings = live_.settings(); };  // a script has its initial settings
  if (is_slow_to_change()) return begin({"restarting", run, then});
  run();
  then();
}

void App::apply_settings() {
  const Settings now = live_.settings();
  if (!workspace_.adjusting) extends_last_change_ = false;
  if (workspace_.settings == now) return;
  // If a new World is expensive, applies the change when the slider is released.
  Settings only_launch_shape = now;
  only_launch_shape.run.shape = workspace_.settings.run.shape;
  const bool only_launch = workspace_.settings == only_launch_shape;
  const bool cheap =
      only_launch || (!is_slow_to_change() && workspace_.settings.generator.variant != Variant::settled);
  if (workspace_.adjusting && !cheap) return;
  const auto restore = [this] { workspace_.settings = live_.settings(); };
  try {
    std::optional<RunState> rest;
    const std::optional<Scene> next = live_.scene_after_restart(workspace_.settings);
    if (next && !finish_presimulation(*next, rest)) return;
    const auto run = [this, rest, request = workspace_.settings, extends = extends_last_change_] {
      change_notice_ = live_.apply(request, rest ? &*rest : nullptr, extends);
    };
    const auto then = [this] {
      workspace_.settings = live_.settings();
      if (!change_notice_.empty()) show_notice(change_notice_);
      follow_selection();
    };
    extends_last_change_ = workspace_.adjusting;
    if (!only_launch && is_slow_to_change())
      return begin({fmt::format("preparing {} bodies", grouped_number(workspace_.settings.generator.count)),
                    run, then});
    run();
    then();
  } catch (...) {
    restore();
    throw;
  }
}

void App::export_history(bool csv) {
  const auto window = static_cast<std::size_t>(std::max(workspace_.window, 1));
  const std::string file =
      unused_file_name(fmt::format("history_{:06}", live_.world().steps()), csv ? "csv" : "json");
  write_file_atomically(file,
                        csv ? history_csv(live_.history(), window) : history_json(live_.history(), window));
  show_notice("wrote " + file);
}

void App::export_changes() {
  const std::string file = unused_file_name(fmt::format("changes_{:06}", live_.world().steps()), "json");
  write_file_atomically(file, live_.changes_text());
  show_notice("wrote " + file);
}

void App::save_recording() {
  const std::string file = unused_file_name(fmt::format("run_{:06}", live_.timeline().last()), "recording");
  make_folder("captures");
  begin({"writing " + file,
         [this, file] { write_run(file, live_.timeline(), live_.changes(), live_.world()); },
         [this, file] { show_notice("wrote " + file); }});
}

void App::spawn_projectile() {
  const Vector3d eye = scene_.camera().eye();
  World& world = live_.world();
  const std::vector<Vector3d> position = world.bodies().position;
  const ProjectileSpace room{world.initial().box, world.scene().obstacles, position, world.initial().radius};
  const std::optional<Body> ball =
      make_projectile(eye, scene_.camera().target - eye, scene_.scene_size(), room);
  if (!ball) return show_notice("no space for a ball in this direction");
  Change change;
  change.add = {*ball};
  change_world(std::move(change), "adding a body");
}

void App::remove_selected() {
  if (!workspace_.selection) return;
  Change change;
  change.remove = {*workspace_.selection};
  change_world(std::move(change), "removing a body");
}

/// Updates the id of the selected body. Clears the selection if the body was removed.
void App::follow_selection() {
  const BodyIdMap& ids = live_.last_id_map();
  if (!workspace_.selection || *workspace_.selection >= ids.size()) return;
  const std::uint32_t now = ids[*workspace_.selection];
  workspace_.selection = now == no_body ? std::nullopt : std::optional(now);
  workspace_.follow = workspace_.follow && workspace_.selection;
}

void App::save_picture() {
  const std::string file = unused_file_name(fmt::format("window_{:06}", run_.stats.step), "png");
  make_folder("captures");
  write_png(picture_.read(), file);
  picture_file_ = file;
  show_notice("wrote " + file);
}

}  // namespace collidoscope

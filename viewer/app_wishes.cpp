// What panels and keys asked for since the last frame.

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <utility>

#include "sim_cuda/core/atomic_file.h"
#include "sim_cuda/scene/box_collider.h"
#include "sim_cuda/scene/scene_file.h"
#include "viewer/app_guard.h"
#include "viewer/free_name.h"
#include "viewer/render/image.h"
#include "viewer/session/thrown_ball.h"

namespace collidoscope {

void App::say(const std::string& notice) {
  workspace_.notice = notice;
  notice_since_ = Clock::now();
}

void App::meet_wishes(double seconds) {
  if (!workspace_.notice.empty() && Clock::now() - notice_since_ > std::chrono::seconds(5))
    workspace_.notice.clear();
  if (std::exchange(workspace_.csv_wish, false)) guarded([&] { export_history(true); });
  if (std::exchange(workspace_.json_wish, false)) guarded([&] { export_history(false); });
  guarded([&] { scene_.meet_wish(std::exchange(workspace_.camera_wish, CameraWish::none), live_); });
  guarded([&] { apply_settings(seconds); });
  if (std::exchange(workspace_.changes_wish, false)) guarded([&] { export_changes(); });
  if (std::exchange(workspace_.throw_wish, false)) guarded([&] { throw_ball(); });
  if (std::exchange(workspace_.remove_wish, false)) guarded([&] { remove_selected(); });
  const bool pending = workspace_.settings != live_.settings();
  if (workspace_.restart_wish && !pending) guarded([&] { restart(seconds); });
  if (!workspace_.restart_wish && !pending) presimulation_.reset();
  if (workspace_.selection && *workspace_.selection >= live_.world().initial().size())
    workspace_.selection.reset();
  guarded([&] { meet_stop_wish(); });
  guarded([&] { follow_reference(); });
  guarded([&] { advance(seconds); }, true);
  guarded([&] { measure_effects(); });
  guarded([&] { measure_accuracy(seconds); });
  guarded([&] { follow_hard_cases(seconds); });
}

void App::measure_effects() {
  const Folds& folds = workspace_.folds;
  if (!folds.right || !folds.effects) return;
  const bool another = costs_generation_ != live_.generation();
  if (another || (costs_.begun() && !workspace_.measure_effects)) costs_.begin(live_.world());
  costs_generation_ = live_.generation();
  constexpr double slice = 10;  // ms of a frame
  if (workspace_.measure_effects) costs_.go_on(live_.world(), slice);
}

void App::measure_accuracy(double seconds) {
  if (!shows_accuracy()) return;
  accuracy_.follow(live_.world(), live_.generation(), workspace_.accuracy);
  // ms of a frame: half of what the last one took, so that a slow renderer does not take it all.
  const double slice = std::clamp(500 * seconds, 12.0, 60.0);
  if (workspace_.accuracy.running) accuracy_.go_on(slice);
}

void App::follow_reference() {
  const bool wished = std::exchange(workspace_.reference_wish, false);
  if (!workspace_.layers.ask_a_reference() || wished) reference_.forget();
  if (workspace_.layers.ask_a_reference()) reference_.follow(live_.world(), live_.generation());
}

/// Whether a run can begin with this scene, in `rest` if it is one that settles. Goes on with settling else:
/// the run that there is stays until then.
bool App::comes_to_rest(const Scene& scene, double seconds, std::optional<RunState>& rest) {
  if (!needs_presimulation(scene)) return true;
  std::string text = write_scene(scene);
  if (!presimulation_ || settling_scene_ != text) {
    presimulation_.emplace(scene, live_.world().options());
    settling_scene_ = std::move(text);
  }
  // ms of a frame: half of what the last one took, so that a slow renderer does not take it all.
  presimulation_->go_on(std::clamp(500 * seconds, 30.0, 250.0));
  if (!presimulation_->done()) {
    say(fmt::format("bodies come to rest first, step {} of {} at most; Esc: leave it as it is",
                    presimulation_->steps(), presimulation_->max_steps()));
    return false;
  }
  rest = presimulation_->take();
  presimulation_.reset();
  workspace_.notice.clear();
  return true;
}

void App::restart(double seconds) {
  std::optional<RunState> rest;
  try {
    if (!live_.scripted() && !comes_to_rest(live_.world().scene(), seconds, rest)) return;
    live_.restart(rest ? &*rest : nullptr);
    workspace_.settings = live_.settings();  // a script begins again with its first ones
  } catch (...) {
    workspace_.restart_wish = false;
    throw;
  }
  workspace_.restart_wish = false;
  due_ = 0;
}

void App::apply_settings(double seconds) {
  const Settings now = live_.settings();
  if (!workspace_.adjusting) slider_goes_on_ = false;
  if (workspace_.settings == now) return;
  // Where a new World takes long, it waits until the slider is let go.
  Settings shape_alone = now;
  shape_alone.shape = workspace_.settings.shape;
  constexpr double at_once = 0.05;
  const bool cheap = workspace_.settings == shape_alone || (live_.last_change_seconds() < at_once &&
                                                            workspace_.settings.variant != Variant::settled);
  if (workspace_.adjusting && !cheap) return;
  try {
    std::optional<RunState> rest;
    const std::optional<Scene> next = live_.next_run(workspace_.settings);
    if (next && !comes_to_rest(*next, seconds, rest)) return;
    const std::string said = live_.apply(workspace_.settings, rest ? &*rest : nullptr, slider_goes_on_);
    slider_goes_on_ = workspace_.adjusting;
    if (!said.empty()) say(said);
    follow_selection();
  } catch (...) {
    workspace_.settings = live_.settings();
    throw;
  }
  workspace_.settings = live_.settings();
}

void App::advance(double seconds) {
  const double time_step = live_.world().scene().physics.time_step;
  const bool wished = workspace_.step_wishes > 0;
  if ((wished || workspace_.playing) && is_held()) return;
  // All values of a slider then act at one state, and are recorded as one change.
  if (workspace_.adjusting_result && !wished) return;
  if (!wished && workspace_.playing)
    due_ = workspace_.speed > 0 ? due_ + seconds * workspace_.speed / time_step : 1;
  if (!wished && !(workspace_.playing && due_ >= 1)) return;
  constexpr double slice = 12;  // ms of a frame
  if (workspace_.layers.ask_a_reference() && !reference_.go_ahead(time_step, slice)) return;
  if (wished)
    --workspace_.step_wishes;
  else  // what the machine cannot keep up with is not made up for later
    due_ = std::min(due_ - 1, 1.0);
  // Whoever looks at forces pays for them.
  const Folds& folds = workspace_.folds;
  live_.world().records().record_impulses(workspace_.layers.contacts ||
                                          (workspace_.selection && folds.right && folds.inspector));
  live_.world().records().record_residuals(folds.right && folds.convergence);
  step_once();
  const auto& pause_at = options_.view.pause_at;
  if (pause_at && live_.world().steps() == *pause_at) workspace_.playing = false;
}

void App::export_history(bool csv) {
  const auto window = static_cast<std::size_t>(std::max(workspace_.window, 1));
  const std::string file =
      free_name(fmt::format("history_{:06}", live_.world().steps()), csv ? "csv" : "json");
  write_file_atomically(file,
                        csv ? history_csv(live_.history(), window) : history_json(live_.history(), window));
  say("wrote " + file);
}

void App::export_changes() {
  const std::string file = free_name(fmt::format("changes_{:06}", live_.world().steps()), "json");
  write_file_atomically(file, live_.changes_text());
  say("wrote " + file);
}

void App::throw_ball() {
  const Vector3d eye = scene_.camera().eye();
  World& world = live_.world();
  const std::vector<Vector3d> position = world.bodies().position;
  const BallRoom room{world.initial().box, world.scene().obstacles, position, world.initial().radius};
  const std::optional<Body> ball = thrown_ball(eye, scene_.camera().target - eye, scene_.scene_size(), room);
  if (!ball) return say("on this line of sight there is no room for a ball");
  Change change;
  change.add = {*ball};
  live_.apply(std::move(change));
  workspace_.settings = live_.settings();
}

void App::remove_selected() {
  if (!workspace_.selection) return;
  Change change;
  change.remove = {*workspace_.selection};
  live_.apply(std::move(change));
  workspace_.settings = live_.settings();
  follow_selection();
}

/// The selected body keeps its mark where its id has changed; one that is gone loses it.
void App::follow_selection() {
  const BodyIds& ids = live_.last_ids();
  if (!workspace_.selection || *workspace_.selection >= ids.size()) return;
  const std::uint32_t now = ids[*workspace_.selection];
  workspace_.selection = now == no_body ? std::nullopt : std::optional(now);
  workspace_.follow = workspace_.follow && workspace_.selection;
}

void App::save_picture() {
  const std::string file = free_name(fmt::format("window_{:06}", live_.world().steps()), "png");
  make_folder("captures");
  write_png(picture_.read(), file);
  picture_file_ = file;
  say("wrote " + file);
}

}  // namespace collidoscope

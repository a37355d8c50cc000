// The hard cases panel: runs tests while it is open, and opens a case in place of the scene.

#include <utility>

#include "viewer/app.h"

namespace collidoscope {

void App::follow_hard_cases() {
  if (!shows_hard_cases()) return;
  HardCasesRequests& requests = workspace_.hard_cases;
  if (std::exchange(requests.back, false)) return restore_scene_before();
  stability_.follow(live_.world(), requests);
  if (auto opened = stability_.take_opened()) show_case(std::move(*opened));
  if (stability_.done()) return;
  constexpr double slice = 20;  // ms
  measuring_ = true;
  slices_.emplace_back([this] {
    stability_.advance(slice);
    return !stability_.done();
  });
}

void App::show_case(LiveStability::Opened opened) {
  if (!run_before_cases_)
    run_before_cases_ = ReplacedRun{Start{live_.world().scene(), snapshot_of(live_.world())},
                                    live_.world().options(), live_.record()};
  live_.open(std::move(opened.world), std::move(opened.script));
  stability_.case_shown(run_before_cases_->start.scene.name);
  show_another_scene();
  if (opened.failed) workspace_.playing = false;
  workspace_.selection = opened.body;
  show_notice(opened.notice);
}

void App::restore_scene_before() {
  if (!run_before_cases_) return;
  begin({"opening " + run_before_cases_->start.scene.name,
         [this] {
           live_.open(run_before_cases_->start.world(run_before_cases_->options), run_before_cases_->record);
         },
         [this] {
           run_before_cases_.reset();
           stability_.no_case_shown();
           show_another_scene();
         }});
}

void App::show_another_scene() {
  workspace_.settings = live_.settings();
  workspace_.selection.reset();
  workspace_.tree.node.reset();
  workspace_.follow = false;
  scene_.forget_camera();
  window_.set_title("Collidoscope · " + live_.world().scene().name);
}

}  // namespace collidoscope

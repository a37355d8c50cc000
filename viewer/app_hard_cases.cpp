// The list of hard cases: its trials go on while it is unfolded, and a case takes the place of the scene.

#include <algorithm>
#include <utility>

#include "viewer/app.h"

namespace collidoscope {

void App::follow_hard_cases(double seconds) {
  if (!shows_hard_cases()) return;
  HardCasesWishes& wishes = workspace_.hard_cases;
  if (std::exchange(wishes.back, false)) return to_scene_before();
  stability_.follow(live_.world(), wishes);
  // ms of a frame: half of what the last one took, so that a slow renderer does not take it all.
  stability_.go_on(std::clamp(500 * seconds, 12.0, 60.0));
  if (auto opened = stability_.take_opened()) show_case(std::move(*opened));
}

void App::show_case(LiveStability::Opened opened) {
  if (!before_cases_)
    before_cases_ = Left{Start{live_.world().scene(), snapshot_of(live_.world())}, live_.world().options(),
                         live_.record()};
  live_.open(std::move(opened.world), std::move(opened.script));
  stability_.shows_case(before_cases_->start.scene.name);
  show_another_scene();
  if (opened.failed) workspace_.playing = false;
  workspace_.selection = opened.body;
  say(opened.notice);
}

void App::to_scene_before() {
  if (!before_cases_) return;
  live_.open(before_cases_->start.world(before_cases_->options), std::move(before_cases_->record));
  before_cases_.reset();
  stability_.shows_none();
  show_another_scene();
}

void App::show_another_scene() {
  workspace_.settings = live_.settings();
  workspace_.selection.reset();
  workspace_.tree.node.reset();
  workspace_.follow = false;
  scene_.forget_camera();
  due_ = 0;
}

}  // namespace collidoscope

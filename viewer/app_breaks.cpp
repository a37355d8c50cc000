// Where the run stops for somebody to look, and what is done about it.

#include <fmt/format.h>

#include <utility>

#include "sim_cuda/core/atomic_file.h"
#include "viewer/app.h"
#include "viewer/free_name.h"

namespace collidoscope {

void App::meet_stop_wish() {
  const StopWish wish = std::exchange(workspace_.breaks.stop, StopWish::none);
  const std::optional<StopFacts> stop = breaks_.stop(live_);
  if (wish == StopWish::none || !stop) return;
  switch (wish) {
    case StopWish::none:
      break;
    case StopWish::go_on:
      breaks_.go_on();
      if (stop->found) {
        workspace_.settings.guards.reset();
        apply_settings(0);
        say("guards are off now");
      }
      workspace_.playing = true;
      break;
    case StopWish::freeze:
      if (!stop->can_freeze) break;
      breaks_.go_on();
      live_.freeze(*stop->body);
      say(fmt::format("body {} is frozen where it was; Space goes on", *stop->body));
      break;
    case StopWish::save: {
      std::string bytes;
      write_snapshot(breaks_.before(live_), [&](std::string_view more) { bytes += more; });
      const std::string file = free_name(fmt::format("before_{:06}", stop->before + 1), "snapshot");
      write_file_atomically(file, bytes);
      say(fmt::format("wrote {}, a snapshot of state {}", file, stop->before));
      break;
    }
  }
}

/// One step, if nothing is in its way.
void App::step_once() {
  const BreakConditions conditions = workspace_.breaks.conditions();
  const std::size_t frozen = live_.world().guards().frozen().size();
  const double time_step = live_.world().scene().physics.time_step;
  breaks_.before_step(live_, conditions);
  if (live_.step(true)) {
    reference_.stepped(time_step);
    simulated_ += time_step;
  }
  if (live_.scripted()) workspace_.settings = live_.settings();
  if (breaks_.after_step(live_, conditions)) {
    workspace_.playing = false;
    workspace_.step_wishes = 0;
    if (const auto& body = breaks_.stop(live_)->body) workspace_.selection = body;
  } else if (live_.world().guards().frozen().size() > frozen) {
    say("frozen: " + describe(*live_.world().guards().finding()));
  }
}

/// Whether guards hold the run; at a condition that is met, it goes on as soon as somebody plays or steps.
bool App::is_held() {
  if (!breaks_.stop(live_)) return false;
  if (!live_.world().guards().paused()) {
    breaks_.go_on();
    return false;
  }
  workspace_.playing = false;
  workspace_.step_wishes = 0;
  return true;
}

}  // namespace collidoscope

// Stops of the run, and the actions at a stop.

#include <fmt/format.h>

#include <utility>

#include "sim_cuda/core/atomic_file.h"
#include "viewer/app.h"
#include "viewer/unused_file_name.h"

namespace collidoscope {

void App::handle_stop_request() {
  const StopRequest request = std::exchange(workspace_.breaks.stop, StopRequest::none);
  const std::optional<StopView> stop = breaks_.stop(live_);
  if (request == StopRequest::none || !stop) return;
  switch (request) {
    case StopRequest::none:
      break;
    case StopRequest::resume:
      breaks_.resume();
      if (stop->is_violation) {
        workspace_.settings.guards.reset();
        apply_settings();
        show_notice("guards are switched off");
      }
      workspace_.playing = true;
      break;
    case StopRequest::freeze:
      if (!stop->can_freeze) break;
      breaks_.resume();
      live_.freeze(*stop->body);
      show_notice(fmt::format("body {} is frozen; Space: resume", *stop->body));
      break;
    case StopRequest::save: {
      const std::string file =
          unused_file_name(fmt::format("before_{:06}", stop->state_before + 1), "snapshot");
      begin({"saving the state before the stop",
             [this, file] {
               std::string bytes;
               write_snapshot(breaks_.snapshot_before(live_), [&](std::string_view more) { bytes += more; });
               write_file_atomically(file, bytes);
             },
             [this, file, state = stop->state_before] {
               show_notice(fmt::format("wrote {}, a snapshot of state {}", file, state));
             }});
      break;
    }
  }
}

/// Whether guards block the run. At a break condition, the request to play or step resumes the run.
bool App::is_blocked_by_stop() {
  if (!breaks_.stop(live_)) return false;
  if (!live_.world().validation().paused()) {
    breaks_.resume();
    return false;
  }
  workspace_.playing = false;
  workspace_.step_requests = 0;
  return true;
}

}  // namespace collidoscope

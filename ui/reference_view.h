#pragma once
// What panels and pictures say of the reference that goes along with a run (viewer/session/live_reference.h).
// Plain data; whoever runs the scene fills it.

#include <cstdint>
#include <string>

namespace collidoscope {

struct ReferenceView {
  std::string name;                ///< what it is, in a few words; empty: nobody asked for one
  std::string unavailable_reason;  ///< why there is none of the state that is shown, or empty
  std::int64_t start_state = 0;    ///< the state that it began with
  double rms = 0, max = 0;         ///< m, how far the bodies are from where it has them
  double error_estimate = 0;       ///< m, r.m.s. of its own error, about; 0: exact

  bool known() const { return !name.empty() && unavailable_reason.empty(); }
};

}  // namespace collidoscope

#pragma once
// Data about the reference of a run (viewer/session/live_reference.h), for panels and pictures. A plain
// struct, written by the caller.

#include <cstdint>
#include <string>

namespace collidoscope {

struct ReferenceView {
  std::string name;                ///< short description; empty: not requested
  std::string unavailable_reason;  ///< why there is no reference for the shown state; empty: available
  std::int64_t start_state = 0;    ///< initial state of the reference
  double rms = 0, max = 0;         ///< m, position error of the bodies against the reference
  double error_estimate = 0;       ///< m, estimated rms error of the reference itself; 0: exact

  bool known() const { return !name.empty() && unavailable_reason.empty(); }
};

}  // namespace collidoscope

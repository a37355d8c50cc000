#pragma once
// SIGINT (Ctrl-C) and SIGTERM as a flag that is read between two pieces of work, or as a request to cancel
// the work in progress. One object at a time. While it lives, the first signal is only noted; a second one
// does what it did before. A signal that the parent ignores stays ignored.

#include <functional>

#include "sim_cuda/core/cancellation.h"

namespace collidoscope {

class InterruptHandler {
 public:
  InterruptHandler();
  /// The first signal also requests `cancellation`, which must outlive all work that reads it. `at_once`: if
  /// the work has not ended 0.9 s later, the signal ends the program, and temporary files are deleted.
  InterruptHandler(Cancellation& cancellation, bool at_once);
  ~InterruptHandler();
  InterruptHandler(const InterruptHandler&) = delete;
  InterruptHandler& operator=(const InterruptHandler&) = delete;

  bool requested() const;
  /// The work ends by itself soon after a signal: the program is no longer ended after 0.9 s.
  static void wait_for_work();
  /// Call when the work has ended: later signals are noted, and no longer end the program after 0.9 s.
  static void work_ended();
  /// Ends the program as the signal would have, so that shells and scripts see that it was.
  [[noreturn]] static void reraise();
};

/// What `work` returns; a signal cancels it, within a second unless it says wait_for_work(), and then ends
/// the program as it would have.
int run_interruptible(const std::function<int(Cancellation&)>& work);

}  // namespace collidoscope

#pragma once
// Ctrl-C (SIGINT) and SIGTERM as something to look at between two pieces of work, or as a request to cancel
// what is under way. One at a time; from its making to its end the first signal is only noted, a second one
// ends the program as ever. A signal that the program was started to ignore is ignored.

#include <functional>

#include "sim_cuda/core/cancellation.h"

namespace collidoscope {

class Interruption {
 public:
  Interruption();
  /// The first signal also requests `cancellation`, which must outlive the program's other work. `at_once`:
  /// work that has not ended 0.9 s later is ended with the program, as the signal would have.
  Interruption(Cancellation& cancellation, bool at_once);
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  bool wished() const;
  /// The work has ended. What is left to do is done even where a signal comes, and may take its time.
  static void met();
  /// Ends the program as the signal would have, so that shells and scripts see that it was.
  [[noreturn]] static void obey();
};

/// What `work` returns; a signal cancels it, within a second, and then ends the program as it would have.
int until_interrupted(const std::function<int(Cancellation&)>& work);

}  // namespace collidoscope

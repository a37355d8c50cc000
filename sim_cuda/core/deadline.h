#pragma once
// Deadline of a time slice. Used to split long work over several frames.

#include <chrono>

namespace collidoscope {

class Deadline {
 public:
  /// Ends in `milliseconds` from now; infinity: never.
  explicit Deadline(double milliseconds)
      : end_(milliseconds < 1e12 ? Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                                      std::chrono::duration<double, std::milli>(milliseconds))
                                 : Clock::time_point::max()) {}
  bool passed() const { return Clock::now() >= end_; }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point end_;
};

}  // namespace collidoscope

#pragma once
// The time step of a scene: a duration in seconds, or a whole number of steps per second. The number is kept
// so that files and messages can write it exactly. Converts to and from seconds.

#include <optional>

namespace collidoscope {

class TimeStep {
 public:
  constexpr TimeStep() = default;
  /// Duration in seconds, > 0. validate() checks the range.
  constexpr TimeStep(double seconds) : seconds_(seconds) {}
  /// A step of 1/n s. n > 0.
  static constexpr TimeStep per_second(int n) {
    TimeStep step(1.0 / n);
    step.per_second_ = n;
    return step;
  }

  constexpr operator double() const { return seconds_; }
  constexpr double seconds() const { return seconds_; }
  /// n if the step was given as steps per second, else unset.
  constexpr std::optional<int> steps_per_second() const { return per_second_; }

  /// Compares the durations only.
  friend constexpr bool operator==(const TimeStep& a, const TimeStep& b) { return a.seconds_ == b.seconds_; }
  friend constexpr bool operator==(const TimeStep& a, double seconds) { return a.seconds_ == seconds; }

 private:
  double seconds_ = 1.0 / 30;
  std::optional<int> per_second_;
};

}  // namespace collidoscope

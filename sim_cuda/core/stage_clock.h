#pragma once
// Measures the time of each stage. A stage ends where the next one begins (Executor::begin_stage). Times of
// stages with the same name are summed within a step. The CPU reads the clock directly. On a GPU, events in
// the step's graph measure the time, and are read after the graph has run (step_graph.h).

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "sim_cuda/core/stage_times.h"

namespace collidoscope {

/// Ring buffer of the most recent samples, so that memory use is bounded for runs of any length.
class TimeSamples {
 public:
  static constexpr std::size_t capacity = 8192;
  void add(float milliseconds);
  std::int64_t count() const { return count_; }                 ///< total number of added samples
  float last() const { return last_; }                          ///< 0 before the first sample
  const std::vector<float>& recent() const { return recent_; }  ///< unordered

 private:
  std::vector<float> recent_;
  std::int64_t count_ = 0;
  float last_ = 0;
};

class StageClock {
 public:
  struct Entry {
    std::string name;
    int launches = 0;
    bool library_launch = false;
    StageLaunch launch;      ///< launch of the kernel with the most items
    TimeSamples samples_ms;  ///< one per measured step
    float step_ms = 0;       ///< sum over the step in progress
  };

  /// Returns the entry of that name; appends it on first use.
  Entry& entry(const char* name);
  /// Adds the time of one run of a stage to the step in progress.
  void add(std::size_t index, double milliseconds) {
    entries_[index].step_ms += static_cast<float>(milliseconds);
  }
  Entry& at(std::size_t index) { return entries_[index]; }
  std::size_t index(const Entry& e) const { return static_cast<std::size_t>(&e - entries_.data()); }
  /// Ends the step in progress: its sums become one sample per stage.
  void commit_step();
  /// Stage times of the step in progress, in last_ms. Launch counts are those of the last uninstrumented
  /// step.
  std::vector<StageTime> step_in_progress() const;
  /// Discards the times of the step in progress, which will be repeated.
  void discard_step();
  /// Adds the time of an uninstrumented step, ms.
  void add_plain_step(double milliseconds) { plain_ms_.add(static_cast<float>(milliseconds)); }
  /// Records one more kernel of a stage. Only the launch with the most items is kept.
  void add_launch(std::size_t index, const StageLaunch& launch);
  void clear_launches();  ///< sets the launch counts to 0
  void clear_shapes();    ///< clears the launches of add_launch()

  RunTimes times() const;
  /// Newest samples only, without medians. Its cost does not grow with the number of samples.
  RunTimes latest() const;

 private:
  std::vector<Entry> entries_;
  TimeSamples plain_ms_;
};

}  // namespace collidoscope

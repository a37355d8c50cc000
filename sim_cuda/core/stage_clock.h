#pragma once
// How long each stage takes. A stage ends where the next one begins (Executor::begin_stage). The times of one
// name within a step are added up. On the CPU the clock is read at once. On a GPU events in the step's graph
// measure the time, and are read after it has run (step_graph.h).

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "sim_cuda/core/stage_times.h"

namespace collidoscope {

/// The most recent samples of a time, so that a run of any length keeps a bounded memory of itself.
class TimeSamples {
 public:
  static constexpr std::size_t capacity = 8192;
  void add(float milliseconds);
  std::int64_t count() const { return count_; }                 ///< all that were added, forgotten ones too
  float last() const { return last_; }                          ///< 0 before the first
  const std::vector<float>& recent() const { return recent_; }  ///< in no particular order

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
    StageLaunch launch;      ///< of its kernel with the most items
    TimeSamples samples_ms;  ///< one per measured step
    float step_ms = 0;       ///< of the step in progress
  };

  /// The entry of that name, made at the end of the list at its first use.
  Entry& entry(const char* name);
  /// The time of one run of a stage within the step in progress.
  void add(std::size_t index, double milliseconds) {
    entries_[index].step_ms += static_cast<float>(milliseconds);
  }
  Entry& at(std::size_t index) { return entries_[index]; }
  std::size_t index(const Entry& e) const { return static_cast<std::size_t>(&e - entries_.data()); }
  /// Ends the step in progress: its sums become a sample of each stage.
  void commit_step();
  /// What each stage of the step in progress took, in last_ms, by name; launches are of the last plain step.
  std::vector<StageTime> step_in_progress() const;
  /// Forgets the step in progress: it will be done again.
  void discard_step();
  /// A plain step of that many milliseconds.
  void add_plain_step(double milliseconds) { plain_ms_.add(static_cast<float>(milliseconds)); }
  /// One more kernel of a stage. The launch that is kept is the one with the most items.
  void add_launch(std::size_t index, const StageLaunch& launch);
  void clear_launches();  ///< the counts
  void clear_shapes();    ///< what add_launch() was told

  RunTimes times() const;
  /// The newest samples alone, without medians: cheap however long the run.
  RunTimes latest() const;

 private:
  std::vector<Entry> entries_;
  TimeSamples plain_ms_;
};

}  // namespace collidoscope

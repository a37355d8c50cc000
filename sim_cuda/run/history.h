#pragma once
// Ring buffer of the last steps of a run, for graphs, tables and files: measurements and stage times. Plain
// data on the host, owned by the class that steps the World. Copies share the steps, so copying is fast.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sim_cuda/core/stage_times.h"
#include "sim_cuda/measure/step_stats.h"

namespace collidoscope {

/// One step. A step is timed as a whole or by stage, never both. Times that were not measured are negative.
struct HistoryStep {
  std::int64_t step = 0;  ///< number of the resulting state
  double plain_ms = -1;   ///< whole step without stage timing, ms
  std::vector<float>
      stage_ms;  ///< by History::stages(), ms; empty without stage timing; -1 for a stage that did not run
  bool measured = false;   ///< `stats` is set
  StepStats stats;         ///< of the resulting state
  std::int64_t nodes = 0;  ///< nodes of the tree
  std::int64_t allocated_bytes = 0;

  bool instrumented() const { return !stage_ms.empty(); }
  /// Sum of the stage times, ms; -1 without stage timing.
  double stage_sum() const {
    double sum = 0;
    for (float ms : stage_ms) sum += ms > 0 ? static_cast<double>(ms) : 0.0;
    return instrumented() ? sum : -1;
  }
};

/// Statistics of one time over a window of steps, ms; all 0 without samples.
struct TimeSummary {
  double now = 0, median = 0, p95 = 0;
  int samples = 0;
};

class History {
 public:
  struct Stage {
    std::string name;
    int launches = 0;             ///< per step
    bool library_launch = false;  ///< a part of it ignores (B, T)
    StageLaunch launch{};         ///< of the newest step with stage timing
  };

  explicit History(std::size_t capacity = 3600) : capacity_(capacity > 0 ? capacity : 1) {}

  /// Adds a step. `stages`: stage times of an instrumented step (StageTime::last_ms); empty for a plain
  /// step. New stage names are appended to stages().
  void add(HistoryStep step, const std::vector<StageTime>& stages);
  void clear();
  /// Removes the steps whose state is later than `step`.
  void forget_after(std::int64_t step);

  std::size_t size() const { return steps_.size(); }
  std::size_t capacity() const { return capacity_; }
  /// Step i; 0 is the oldest.
  const HistoryStep& operator[](std::size_t i) const { return *steps_[(first_ + i) % steps_.size()]; }
  const std::vector<Stage>& stages() const { return stages_; }

  /// True if the newest step with stage timing has this stage. Broad phases have different stages.
  bool current(std::size_t stage) const;

  /// Over the newest `window` steps that have this time.
  TimeSummary summarize_stage(std::size_t stage, std::size_t window) const;
  TimeSummary summarize_plain(std::size_t window) const;
  TimeSummary summarize_sum(std::size_t window) const;

 private:
  template <class Value>
  TimeSummary summarize(std::size_t window, Value value) const;

  std::size_t capacity_, first_ = 0;
  std::vector<std::shared_ptr<const HistoryStep>> steps_;
  std::vector<Stage> stages_;
};

/// CSV of the newest `window` steps: a header line, then one row per step. Fields without a measurement are
/// empty.
std::string history_csv(const History& history, std::size_t window);
/// The newest `window` steps as a JSON object: "stages" (name, launches, library_launch, launch, median_ms,
/// p95_ms), "step" and "steps".
std::string history_json(const History& history, std::size_t window);

}  // namespace collidoscope

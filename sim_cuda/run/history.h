#pragma once
// The last steps of a run, for graphs, tables and files: what was measured and what each stage took. A ring:
// old steps make room for new ones. Plain data on the host, owned by whoever steps the World.

#include <cstdint>
#include <string>
#include <vector>

#include "sim_cuda/core/stage_times.h"
#include "sim_cuda/measure/step_stats.h"

namespace collidoscope {

/// One step. A step is timed plain or stage by stage, never both; what was not measured is negative.
struct HistoryStep {
  std::int64_t step = 0;        ///< the state that it led to
  double plain_ms = -1;         ///< the whole step, without a clock inside
  std::vector<float> stage_ms;  ///< by History::stages(); empty in a plain step, -1 for a stage it lacks
  bool measured = false;        ///< whether `stats` is set
  StepStats stats;              ///< at the state that it led to
  std::int64_t nodes = 0;       ///< of the hierarchy
  std::int64_t allocated_bytes = 0;

  bool instrumented() const { return !stage_ms.empty(); }
  /// ms, of all stages; -1 for a plain step.
  double stage_sum() const {
    double sum = 0;
    for (float ms : stage_ms) sum += ms > 0 ? static_cast<double>(ms) : 0.0;
    return instrumented() ? sum : -1;
  }
};

/// What the steps that are kept say of one quantity, in ms; all 0 where there was none.
struct TimeSummary {
  double now = 0, median = 0, p95 = 0;
  int samples = 0;
};

class History {
 public:
  struct Stage {
    std::string name;
    int launches = 0;             ///< per step
    bool library_launch = false;  ///< part of it ignores (B, T)
    StageLaunch launch{};         ///< of the newest step that was timed stage by stage
  };

  explicit History(std::size_t capacity = 3600) : capacity_(capacity > 0 ? capacity : 1) {}

  /// Adds a step. `stages`: of an instrumented step, their times in StageTime::last_ms; empty for a plain
  /// one. Names that are new are added to stages(); their order of appearance stays.
  void add(HistoryStep step, const std::vector<StageTime>& stages);
  void clear();

  std::size_t size() const { return steps_.size(); }
  std::size_t capacity() const { return capacity_; }
  /// 0 is the oldest that is kept.
  const HistoryStep& operator[](std::size_t i) const { return steps_[(first_ + i) % steps_.size()]; }
  const std::vector<Stage>& stages() const { return stages_; }

  /// Whether the newest step that was timed stage by stage has that stage: broad phases differ in theirs.
  bool current(std::size_t stage) const;

  /// Over the newest `window` steps that have that time.
  TimeSummary summarize_stage(std::size_t stage, std::size_t window) const;
  TimeSummary summarize_plain(std::size_t window) const;
  TimeSummary summarize_sum(std::size_t window) const;

 private:
  template <class Value>
  TimeSummary summarize(std::size_t window, Value value) const;

  std::size_t capacity_, first_ = 0;
  std::vector<HistoryStep> steps_;
  std::vector<Stage> stages_;
};

/// The newest `window` steps: a line of names, then a row for each step; empty fields for what was not
/// measured.
std::string history_csv(const History& history, std::size_t window);
/// The same as one JSON object: "stages" (name, launches, own_shape, launch, median_ms, p95_ms), "step" and
/// "steps".
std::string history_json(const History& history, std::size_t window);

}  // namespace collidoscope

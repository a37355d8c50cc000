#pragma once
// Measures launch shapes (B, T) of a run, by PairedSteps: the reference has the present shape, the candidate
// that of a cell. Both must reach the same state hash. The measured run itself is only read.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/core/stage_launch.h"
#include "sim_cuda/tuning/launch_search.h"
#include "sim_cuda/tuning/paired_steps.h"
#include "sim_cuda/tuning/tuner_record.h"
#include "sim_cuda/world.h"

namespace collidoscope {

/// Values of B and T of the map for a device. GPU: T from 32 to 1024, B in doublings around a block per
/// multiprocessor. CPU: B * T lanes share the items.
struct LaunchAxes {
  std::vector<int> blocks, threads;
  int thread_unit;
  std::int64_t middle;  ///< B * T
  /// On a CPU, other load comes and goes.
  int pairs_at_once = LaunchSearch::most_pairs;
};
/// `multiprocessors`: 0 for a CPU.
LaunchAxes launch_axes(int multiprocessors, std::int64_t bodies);

class LaunchTuner {
 public:
  /// Copies the present state. `budget`: s, of all measurements together. `confirmation_pairs`: fresh pairs
  /// of the chosen shape, and of the best shapes of stages, while the budget lasts. Throws as World does.
  LaunchTuner(World& world, double budget, int confirmation_pairs = LaunchSearch::fresh_pairs);

  /// Measures for about `milliseconds`, and at least one cell. Throws Cancelled; it can go on afterwards.
  void advance(double milliseconds);
  bool done() const { return done_; }

  /// All finished measurements of cells, for restore() in another process.
  TunerRecord record() const { return {spent_, tasks_}; }
  /// Goes on from a record. Call it first. Returns false, and changes nothing, if the record is of another
  /// search. The caller checks that the run is the same.
  bool restore(const TunerRecord& record);

  const LaunchSearch& search() const { return search_; }
  LaunchShape reference() const { return shape_; }  ///< 0: automatic
  double spent() const { return spent_; }           ///< s
  /// Median times of the reference: of a step, ms, and of each stage.
  double reference_ms() const;

  struct Stage {
    std::string name;
    bool obeys = false;       ///< (B, T); the others are launched by libraries
    StageLaunch launch{};     ///< of the reference
    double reference_ms = 0;  ///< median
    // By cell of search().cells():
    /// reference_ms times the median of the ratios, since pairs of different cells are of different states;
    /// NaN: not measured.
    std::vector<double> cell_ms;
    std::vector<double> occupancy;  ///< 0 to 1; 0: not known
    /// With its shape in stage_shapes() over the reference, from the fresh pairs of stage_confirmation().
    RatioEstimate confirmation;
  };
  std::vector<Stage> stages() const;

  /// By cell, the sums of all its tasks; may be shorter than search().cells().
  const std::vector<CellTimes>& cell_times() const { return cell_times_; }

  /// The best shape of each stage that obeys (B, T), if its time is below that of the reference.
  StageShapes stage_shapes() const;
  /// Whether any shape has enough pairs for stage_shapes().
  bool compared_stages() const;
  /// All of them together over the reference, from fresh pairs.
  RatioEstimate stage_confirmation() const { return estimate_ratio(stage_ratios_); }
  /// How the state with all of them differs; empty: it does not.
  const std::string& stage_difference() const { return stage_difference_; }

  /// Replaces World::state_hash(). For tests.
  void set_hash(std::function<std::uint64_t(World&)> hash) { pair_.set_hash(std::move(hash)); }

 private:
  using Clock = PairedSteps::Clock;
  TunerRecord::Task measure(const LaunchSearch::Task& task, double search_ms);
  void measure_stage_shapes();
  /// Stage times of the last pair.
  std::vector<TunerRecord::StagePair> stage_pairs() const;
  /// Notes stage times of a pair. No cell: of stage_shapes().
  void note_stages(std::optional<std::size_t> cell, const std::vector<TunerRecord::StagePair>& pairs);
  /// Notes what the search does not keep.
  void note(std::size_t cell, const TunerRecord::Pair& pair);
  void note(const TunerRecord::Task& task);

  LaunchShape shape_;
  double budget_, spent_ = 0;
  int confirmation_pairs_;
  PairedSteps pair_;
  LaunchSearch search_;
  std::optional<LaunchSearch::Task> task_;  ///< in progress; kept if it is cancelled
  bool hurried_ = false;                    ///< before task_
  std::vector<TunerRecord::Task> tasks_;    ///< finished
  bool done_ = false;
  std::vector<double> stage_ratios_;
  std::string stage_difference_;
  Clock::time_point ends_;  ///< of the budget
  std::vector<double> reference_ms_;
  std::vector<CellTimes> cell_times_;
  struct StageSamples {
    std::string name;
    bool obeys = false;
    StageLaunch launch{};
    std::vector<float> ms;  ///< of the reference
    // By cell; may be shorter than search().cells().
    std::vector<std::vector<float>> ratios;
    std::vector<double> occupancy;
    std::vector<double> fresh;  ///< ratios with stage_shapes()
  };
  std::vector<StageSamples> stages_;
};

}  // namespace collidoscope

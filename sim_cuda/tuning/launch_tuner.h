#pragma once
// Measures launch shapes (B, T) of a run. Two worlds start from copies of one state: the reference with the
// present shape, the other with the shape of a cell. They make the same steps in turns, and must reach the
// same state hash. The measured run itself is only read.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/core/stage_launch.h"
#include "sim_cuda/run/run_state.h"
#include "sim_cuda/tuning/launch_search.h"
#include "sim_cuda/world.h"

namespace collidoscope {

/// Values of B and T of the map for a device. GPU: T from 32 to 1024, B in doublings around a block per
/// multiprocessor. CPU: B * T lanes share the items.
struct LaunchAxes {
  std::vector<int> blocks, threads;
  int thread_unit;
  std::int64_t middle;  ///< B * T
};
/// `multiprocessors`: 0 for a CPU.
LaunchAxes launch_axes(int multiprocessors, std::int64_t bodies);

class LaunchTuner {
 public:
  /// Copies the present state. `budget`: s, of all measurements together. Throws as World does.
  LaunchTuner(World& world, double budget);

  /// Measures for about `milliseconds`, and at least one cell. Throws Cancelled; it can go on afterwards.
  void advance(double milliseconds);
  bool done() const { return done_; }

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
    std::vector<double> cell_ms;    ///< median; NaN: not measured
    std::vector<double> occupancy;  ///< 0 to 1; 0: not known
  };
  std::vector<Stage> stages() const;

  /// How long the measurements of a cell took, of all its tasks, ms.
  struct CellTimes {
    double search = 0;                                  ///< the decision to measure it
    double setup = 0;                                   ///< change of shape, and the first steps
    double benchmark = 0;                               ///< timed steps of cell and reference
    double check = 0;                                   ///< state hashes
    std::chrono::system_clock::time_point measured_at;  ///< end of the last task
  };
  /// By cell; may be shorter than search().cells().
  const std::vector<CellTimes>& cell_times() const { return cell_times_; }

  /// The best shape of each stage that obeys (B, T), if its time is below that of the reference.
  StageShapes stage_shapes() const;
  /// All of them together over the reference, from fresh pairs.
  RatioEstimate stage_confirmation() const { return estimate_ratio(stage_ratios_); }
  /// How the state with all of them differs; empty: it does not.
  const std::string& stage_difference() const { return stage_difference_; }

  /// Replaces World::state_hash(). For tests.
  void set_hash(std::function<std::uint64_t(World&)> hash) { hash_ = std::move(hash); }

 private:
  using Clock = std::chrono::steady_clock;
  void measure(const LaunchSearch::Task& task, double search_ms);
  void measure_stage_shapes();
  /// Calls `note` with the times of each pair, ms per step. Returns "", or how the states differ.
  std::string measure_pairs(int pairs, const std::function<void(double, double)>& note, CellTimes& times);
  double time_steps(World& world);
  void note_stages(const World& world, std::size_t column);

  Scene scene_;
  RunState state_;
  LaunchShape shape_;
  double budget_, spent_ = 0;
  World reference_, candidate_;
  LaunchSearch search_;
  std::optional<LaunchSearch::Task> task_;  ///< in progress; kept if it is cancelled
  std::function<std::uint64_t(World&)> hash_;
  bool done_ = false;
  std::vector<double> stage_ratios_;
  std::string stage_difference_;
  Clock::time_point ends_;  ///< of the budget
  std::vector<double> reference_ms_;
  std::vector<CellTimes> cell_times_;
  struct StageSamples {
    std::string name;
    bool obeys;
    // Column 0: the reference; then by cell.
    std::vector<std::vector<float>> ms;
    std::vector<StageLaunch> launch;
  };
  std::vector<StageSamples> stages_;
};

}  // namespace collidoscope

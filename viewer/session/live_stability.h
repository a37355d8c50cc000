#pragma once
// The hard cases (sim_cuda/stability/) beside a running scene: test runs a time slice per call, and runs to
// the failing state of a test run. The running world is not changed. Cases are read on first use. Owns the
// cases, the present test run and the run to a requested state.

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/stability/hard_case_simulation.h"
#include "sim_cuda/stability/test_run.h"
#include "ui/hard_cases_view.h"
#include "viewer/session/live_world.h"

namespace collidoscope {

class LiveStability {
 public:
  /// `folder` of the cases; `options` of their runs, except executor and threads.
  LiveStability(std::string folder, RunOptions options)
      : folder_(std::move(folder)), options_(std::move(options)) {}

  /// Sets the executor of the test runs to that of `world`; results of another executor are discarded. Throws
  /// InputError and MachineError if a requested case cannot be opened.
  void follow(const World& world, HardCasesRequests& requests);
  /// Works for about `milliseconds`, at least one step. Does nothing when done. Throws if a step towards a
  /// requested state throws; test runs do not throw.
  void advance(double milliseconds);
  bool done() const { return queue_.empty() && !opening_; }

  /// A run at the requested state.
  struct Opened {
    World world;
    LiveWorld::Script script;  ///< no changes if the case has none
    bool failed;               ///< whether an assertion fails at this state
    std::optional<std::uint32_t> body;
    std::string notice;
  };
  /// Returns the opened run once, when it has reached the state.
  std::optional<Opened> take_opened();
  /// Reports that a case is shown in place of the scene `before`, or that none is shown.
  void case_shown(const std::string& before);
  void no_case_shown();

  const HardCasesView& view();

 private:
  struct Place {
    std::size_t hard_case, test_run;  ///< indices of the case and of its test run
  };
  struct Opening {
    Place place;
    bool of_test_run;  ///< false: the case itself
    HardCaseSimulation run;
    LiveWorld::Script script;
    std::int64_t target;
  };
  TestRunView& view_at(const Place& place) { return view_.cases[place.hard_case].test_runs[place.test_run]; }
  void read();
  void begin_anew(ExecutorKind executor);
  void enqueue(std::size_t hard_case, bool again);
  void stop();
  void open(const HardCasesRequests::Opening& request);

  std::string folder_;
  RunOptions options_;
  bool read_ = false;
  ExecutorKind executor_ = ExecutorKind::automatic;
  std::vector<HardCase> cases_;
  std::vector<std::vector<TestConfiguration>> configurations_;  ///< by case and test run
  std::deque<Place> queue_;                                     ///< the first one is running
  std::optional<TestRun> test_run_;
  std::optional<Opening> opening_;
  HardCasesView view_;
};

}  // namespace collidoscope

#pragma once
// The hard cases (sim_cuda/stability/) beside a running scene: their test runs in slices, so that the picture
// keeps moving, and the way to the state of a test run that somebody wants to look at. The run on the screen
// is never touched. Owns the cases, read when somebody first looks at them, the test run and the run under
// way.

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
  /// `folder` of cases; `options`: how they run, but for the executor and the threads.
  LiveStability(std::string folder, RunOptions options)
      : folder_(std::move(folder)), options_(std::move(options)) {}

  /// Test runs run where `world` runs; what was measured elsewhere is forgotten. Throws InputError and
  /// MachineError where a case that is requested cannot be opened.
  void follow(const World& world, HardCasesRequests& requests);
  /// Works for about so many milliseconds, at least one step; nothing once all is done. Throws as a step
  /// does on the way to a state that is requested; a test run throws nothing.
  void advance(double milliseconds);
  bool done() const { return queue_.empty() && !opening_; }

  /// A run at the state that was requested.
  struct Opened {
    World world;
    LiveWorld::Script script;  ///< without changes where the case has none
    bool failed;               ///< there an assertion does not hold
    std::optional<std::uint32_t> body;
    std::string notice;
  };
  /// Once, as soon as it has come there.
  std::optional<Opened> take_opened();
  /// What is on the screen is no case any more; `before`: or is one, in place of this scene.
  void case_shown(const std::string& before);
  void no_case_shown();

  const HardCasesView& view();

 private:
  struct Place {
    std::size_t hard_case, test_run;  ///< of the cases, and of its test runs
  };
  struct Opening {
    Place place;
    bool of_test_run;  ///< else the case as it is
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
  std::deque<Place> queue_;                                     ///< the first is under way
  std::optional<TestRun> test_run_;
  std::optional<Opening> opening_;
  HardCasesView view_;
};

}  // namespace collidoscope

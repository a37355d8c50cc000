#pragma once
// The hard cases (sim_cuda/stability/) beside a running scene: their trials in slices, so that the picture
// keeps moving, and the way to the state of a trial that somebody wants to look at. The run on the screen is
// never touched. Owns the cases, read when somebody first looks at them, the trial and the run under way.

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/stability/hard_run.h"
#include "sim_cuda/stability/trial.h"
#include "ui/hard_cases_facts.h"
#include "viewer/session/live_world.h"

namespace collidoscope {

class LiveStability {
 public:
  /// `folder` of cases; `options`: how they run, but for the executor and the threads.
  LiveStability(std::string folder, RunOptions options)
      : folder_(std::move(folder)), options_(std::move(options)) {}

  /// Trials run where `world` runs; what was measured elsewhere is forgotten. Throws InputError and
  /// MachineError where a case that is wished for cannot be opened.
  void follow(const World& world, HardCasesWishes& wishes);
  /// Works for about so many milliseconds, at least one step; nothing once all is done. Throws as a step
  /// does on the way to a state that is wished for; a trial throws nothing.
  void go_on(double milliseconds);
  bool done() const { return queue_.empty() && !opening_; }

  /// A run at the state that was wished for.
  struct Opened {
    World world;
    LiveWorld::Script script;  ///< without changes where the case has none
    bool failed;               ///< there a term does not hold
    std::optional<std::uint32_t> body;
    std::string notice;
  };
  /// Once, as soon as it has come there.
  std::optional<Opened> take_opened();
  /// What is on the screen is no case any more; `before`: or is one, in place of this scene.
  void shows_case(const std::string& before);
  void shows_none();

  const HardCasesFacts& facts();

 private:
  struct Place {
    std::size_t one, trial;  ///< of the cases, and of its trials
  };
  struct Opening {
    Place place;
    bool any_trial;  ///< else the case as it is
    HardRun run;
    LiveWorld::Script script;
    std::int64_t target;
  };
  HardTrialFacts& facts_at(const Place& place) { return facts_.cases[place.one].trials[place.trial]; }
  void read();
  void begin_anew(ExecutorKind executor);
  void enqueue(std::size_t one, bool again);
  void stop();
  void open(const HardCasesWishes::Opening& wish);

  std::string folder_;
  RunOptions options_;
  bool read_ = false;
  ExecutorKind executor_ = ExecutorKind::automatic;
  std::vector<HardCase> cases_;
  std::vector<std::vector<TrialSetting>> settings_;  ///< by case and trial
  std::deque<Place> queue_;                          ///< the first is under way
  std::optional<Trial> trial_;
  std::optional<Opening> opening_;
  HardCasesFacts facts_;
};

}  // namespace collidoscope

#pragma once
// What the panel of hard cases shows and asks for. Plain data: the wishes are the panel's, the facts their
// owner's. A case is a scene that tries to break the simulation; a trial of it is one solver in one
// precision.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/scene/names.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

enum class HardMark { not_run, waiting, running, passed, declared_limit, failed, not_applicable };
inline constexpr auto hard_mark_names =
    std::to_array<Named<HardMark>>({{"not run", HardMark::not_run},
                                    {"waiting", HardMark::waiting},
                                    {"running", HardMark::running},
                                    {"passed", HardMark::passed},
                                    {"declared limit", HardMark::declared_limit},
                                    {"failed", HardMark::failed},
                                    {"not applicable", HardMark::not_applicable}});

/// What came of one term: its value nearest to the bound, or the first beyond it.
struct HardTermFacts {
  std::string term, value;  ///< "penetration at most 0.01 m", "0.00123 m"
  bool held = true;
  std::int64_t state = 0;
  std::optional<std::uint32_t> body;
};

struct HardTrialFacts {
  Solver solver = Solver::soft_step;
  Precision precision = Precision::f32;
  HardMark mark = HardMark::not_run;
  double progress = 0;               ///< 0 to 1, of one that is running
  std::string why, failure;          ///< reason of a limit, or why it does not apply; what did not hold
  std::vector<HardTermFacts> terms;  ///< that were measured
  std::int64_t steps = 0;            ///< made
  double seconds = 0;                ///< of the clock
  std::optional<std::int64_t> failed_state;  ///< where it can be looked at
  std::optional<std::uint32_t> body;         ///< that failed there, if it was one

  bool over() const { return mark >= HardMark::passed; }
};

struct HardCaseFacts {
  std::string name, what, group;
  bool refused = false;  ///< its scene must be refused, so nothing of it can be opened; it has one trial
  std::vector<HardTrialFacts> trials;  ///< by solver, then by precision
};

struct HardCasesFacts {
  std::vector<HardCaseFacts> cases;        ///< by group
  std::string executor;                    ///< that trials run on
  std::string lack;                        ///< why there are none, or empty
  std::string doing;                       ///< in a few words; empty: nothing runs
  std::optional<double> opening;           ///< 0 to 1: how far a run has come on its way to a state
  std::optional<std::size_t> shown;        ///< the case that is in the 3D view,
  std::optional<std::size_t> shown_trial;  ///< and which of its trials
  std::string before;                      ///< the scene that was there before all cases; empty: it still is

  std::int64_t count(HardMark mark) const {
    std::int64_t n = 0;
    for (const HardCaseFacts& one : cases)
      for (const HardTrialFacts& trial : one.trials) n += trial.mark == mark;
    return n;
  }
};

struct HardCasesWishes {
  std::string selected;  ///< name of a case; empty: none
  // Cleared by the owner.
  bool run_all = false, run_selected = false, stop = false;
  bool back = false;  ///< to the scene that was there before
  struct Opening {
    std::size_t which;                 ///< of the cases
    std::optional<std::size_t> trial;  ///< of its trials, at the state where it failed; unset: the case at 0
  };
  std::optional<Opening> open;
};

}  // namespace collidoscope

#pragma once
// A trial: one hard case, with one solver, in one precision, on one executor, run to its last state or to the
// first at which a term does not hold. Made in slices, so that somebody can draw in between. Not thread-safe;
// trials side by side share nothing.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/scene/run_options.h"
#include "sim_cuda/snapshot/snapshot.h"
#include "sim_cuda/stability/hard_case.h"

namespace collidoscope {

/// Which of a case's trials.
struct TrialSetting {
  Solver solver = Solver::soft_step;
  Precision precision = Precision::f32;
  ExecutorKind executor = ExecutorKind::cpu;  ///< cpu or cuda

  friend bool operator==(const TrialSetting&, const TrialSetting&) = default;
};

enum class Verdict { passed, failed, declared_limit, not_applicable };
inline constexpr auto verdict_names =
    std::to_array<Named<Verdict>>({{"passed", Verdict::passed},
                                   {"failed", Verdict::failed},
                                   {"declared limit", Verdict::declared_limit},
                                   {"not applicable", Verdict::not_applicable}});

/// What came of one term: its value nearest to a bound, or, where it did not hold, the first beyond it.
struct TermResult {
  bool measured = false, held = true;
  double value = 0, bound = 0;
  std::int64_t state = 0;
  std::optional<std::uint32_t> body;
};

struct TrialResult {
  Verdict verdict = Verdict::passed;
  /// A line: what failed; or the reason of the declared limit; or why it does not apply. Empty: passed.
  std::string why;
  std::string failure;                      ///< the same of a declared limit: what failed there
  std::vector<TermResult> terms;            ///< as they stand in the criterion
  std::optional<std::size_t> failed_term;   ///< unset where nothing failed, or what failed is no term
  std::int64_t last_good = 0;               ///< the last state that was measured before
  std::int64_t steps = 0;                   ///< made
  std::optional<std::uint64_t> state_hash;  ///< of the last state; unset: it did not come to one
  double seconds = 0;                       ///< of the clock
};

class Trial {
 public:
  /// `one` outlives it. `options`: what it runs on, the executor aside; `extended`: its long variant;
  /// `fault`: one of the criterion's, planted in this run.
  Trial(const HardCase& one, const TrialSetting& setting, const RunOptions& options, bool extended = false,
        const CriterionFault* fault = nullptr);
  ~Trial();
  Trial(Trial&&) noexcept;

  /// Works for about so long; false once the result is known. What the machine or the input refuses on the
  /// way is the trial's failure; nothing is thrown.
  bool go_on(double milliseconds);
  bool done() const;
  double progress() const;  ///< 0 to 1
  const TrialResult& result() const;
  const TrialSetting& setting() const;
  std::int64_t bodies() const;  ///< of the case's scene
  /// Of a fault: whether the term that it is to fail did not hold.
  bool fault_shows() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// All trials of a case on an executor: each solver in each precision; of a scene that is refused, which
/// happens before there is a solver, one.
std::vector<TrialSetting> trials_of(const HardCase& one, ExecutorKind executor);
/// Of a fault: the scene's own solver and precision, or those that the fault sets.
TrialSetting setting_of(const HardCase& one, const CriterionFault& fault, ExecutorKind executor);

/// What a trial's run is made of, as a HardRun takes it. Throws InputError where the changes are not such as
/// the scene takes in this setting.
struct TrialStart {
  Scene scene;
  RunOptions options;
  std::vector<Change> changes;
};
TrialStart start_of(const HardCase& one, const TrialSetting& setting, const RunOptions& options);

/// The run as it stood at a state of a trial: made again from the start, so the same bit for bit.
Snapshot state_in_trial(const HardCase& one, const TrialSetting& setting, const RunOptions& options,
                        std::int64_t state);

}  // namespace collidoscope

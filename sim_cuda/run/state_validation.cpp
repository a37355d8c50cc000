#include "sim_cuda/run/state_validation.h"

#include <utility>

#include "sim_cuda/core/cancellation.h"
#include "sim_cuda/run/checkpoint.h"
#include "sim_cuda/run/frozen.h"
#include "sim_cuda/run/simulation.h"

namespace collidoscope {

StateValidation::StateValidation(Simulation& run, bool is_enabled)
    : run_(run), is_enabled_(is_enabled), checkpoint_(std::make_unique<Checkpoint>()) {}
StateValidation::~StateValidation() = default;

void StateValidation::resume_without_guards() {
  run_.runner().discard_graphs();
  run_.pipeline().disable_guards();
  checkpoint_->clear();
  finding_.reset();
  is_enabled_ = paused_ = false;
}

void StateValidation::set_up(Pipeline& pipeline) const {
  if (!is_enabled_) pipeline.disable_guards();
}

void StateValidation::before_step() {
  if (is_enabled_) checkpoint_->save_if_due(run_);
}

void StateValidation::resolve(const FirstViolation& found, std::uint32_t first_run) {
  const ValidationSettings guards = run_.scene.physics.guards.value_or(ValidationSettings{});
  const int run = static_cast<int>(found.run - first_run);
  const std::int64_t at = run_.steps();
  const std::optional<Finding> known = finding_;
  RunState before;
  Finding finding;
  try {
    run_.runner().discard_runs();
    checkpoint_->restore(run_, at);
    before = run_.state();
    finding = run_.pipeline().describe_violation(found, run);
  } catch (const Cancelled&) {
    return_to_ = at;
    finding_ = known;
    throw;
  }
  run_.runner().discard_runs();
  finding.step = before.steps + 1;
  finding.substep += run;
  finding.invalid_before = !is_valid_state(before.bodies, finding.body, guards);
  const InitialBodies now = with_static_bodies(run_.initial, frozen_);
  const bool moves = now.motion.empty() || now.motion[finding.body] == Motion::dynamic;
  const bool freezes = guards.on_failure == OnFailure::freeze && moves;
  if (freezes) freeze(before, finding.body, run_.initial, guards);
  run_.restore(before);
  finding_ = finding;
  paused_ = !freezes;
}

void StateValidation::set_frozen(const std::vector<std::uint32_t>& bodies) {
  if (bodies == frozen_) return;
  run_.runner().discard_graphs();
  const std::vector<std::uint32_t> before = std::exchange(frozen_, bodies);
  try {
    run_.replace_pipeline();
  } catch (...) {
    frozen_ = before;
    throw;
  }
}

void StateValidation::restored() {
  paused_ = false;
  finding_.reset();
  checkpoint_->clear();
}

void StateValidation::recovered() {
  if (!return_to_) return;
  const std::optional<Finding> known = finding_;
  checkpoint_->restore(run_, *std::exchange(return_to_, std::nullopt));
  finding_ = known;
}

}  // namespace collidoscope

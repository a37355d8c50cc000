#include "sim_cuda/run/guarding.h"

#include <utility>

#include "sim_cuda/core/cancellation.h"
#include "sim_cuda/run/frozen.h"
#include "sim_cuda/run/rewind.h"
#include "sim_cuda/run/simulation.h"

namespace collidoscope {

Guarding::Guarding(Simulation& run, bool watched)
    : run_(run), watched_(watched), rewind_(std::make_unique<Rewind>()) {}
Guarding::~Guarding() = default;

void Guarding::dismiss() {
  run_.runner().forget_recorded();
  run_.pipeline().dismiss_guards();
  rewind_->forget();
  finding_.reset();
  watched_ = paused_ = false;
}

void Guarding::set_up(Pipeline& pipeline) const {
  if (!watched_) pipeline.dismiss_guards();
}

void Guarding::before_step() {
  if (watched_) rewind_->before_step(run_);
}

void Guarding::resolve(const FirstFound& found, std::uint32_t first_run) {
  const Guards guards = run_.scene.physics.guards.value_or(Guards{});
  const int run = static_cast<int>(found.run - first_run);
  const std::int64_t at = run_.steps();
  const std::optional<Finding> known = finding_;
  RunState before;
  Finding finding;
  try {
    run_.runner().forget_runs();
    rewind_->to(run_, at);
    before = run_.state();
    finding = run_.pipeline().read_found(found, run);
  } catch (const Cancelled&) {
    return_to_ = at;
    finding_ = known;
    throw;
  }
  run_.runner().forget_runs();
  finding.step = before.steps + 1;
  finding.substep += run;
  finding.before = !is_sane(before.bodies, finding.body, guards);
  const InitialBodies now = with_frozen(run_.initial, frozen_);
  const bool moves = now.motion.empty() || now.motion[finding.body] == Motion::dynamic;
  const bool freezes = guards.on_failure == OnFailure::freeze && moves;
  if (freezes) freeze(before, finding.body, run_.initial, guards);
  run_.adopt(before);
  finding_ = finding;
  paused_ = !freezes;
}

void Guarding::set_frozen(const std::vector<std::uint32_t>& bodies) {
  if (bodies == frozen_) return;
  run_.runner().forget_recorded();
  const std::vector<std::uint32_t> before = std::exchange(frozen_, bodies);
  try {
    run_.replace_pipeline();
  } catch (...) {
    frozen_ = before;
    throw;
  }
}

void Guarding::adopted() {
  paused_ = false;
  finding_.reset();
  rewind_->forget();
}

void Guarding::recovered() {
  if (!return_to_) return;
  const std::optional<Finding> known = finding_;
  rewind_->to(run_, *std::exchange(return_to_, std::nullopt));
  finding_ = known;
}

}  // namespace collidoscope

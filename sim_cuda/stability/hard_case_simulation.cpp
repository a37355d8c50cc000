#include "sim_cuda/stability/hard_case_simulation.h"

#include "sim_cuda/run/run_state.h"

namespace collidoscope {
namespace {

template <class Value>
void set_if_injected(Value& value, const std::optional<Value>& injected) {
  if (injected) value = *injected;
}

void inject(World& world, const InjectedState& injected) {
  if (injected.body >= world.initial().size()) return;
  RunState state = world.state();
  set_if_injected(state.bodies.position[injected.body], injected.position);
  set_if_injected(state.bodies.velocity[injected.body], injected.velocity);
  set_if_injected(state.bodies.angular_velocity[injected.body], injected.angular_velocity);
  set_if_injected(state.bodies.orientation[injected.body], injected.orientation);
  world.restore(state);
}

}  // namespace

HardCaseSimulation::HardCaseSimulation(Scene scene, RunOptions options, std::vector<Change> changes,
                                       std::optional<InjectedState> injected)
    : changes_(std::move(changes)), injected_(std::move(injected)) {
  for (; next_ < changes_.size() && changes_[next_].step == 0 && changes_[next_].freeze.empty(); ++next_)
    apply_change(changes_[next_], scene, options);
  world_ = std::make_unique<World>(scene, options);
  make_due();
}

void HardCaseSimulation::step() {
  const std::int64_t before = state();
  world_->step();
  if (state() == before) return;  // guards paused the run: the changes of this state are already applied
  seconds_ += world_->scene().physics.time_step;
  make_due();
}

void HardCaseSimulation::make_due() {
  for (; next_ < changes_.size() && changes_[next_].step == state(); ++next_)
    if (auto next = world_after_change(*world_, changes_[next_], world_->options())) world_ = std::move(next);
  if (injected_ && injected_->step == state()) inject(*world_, *injected_);
}

}  // namespace collidoscope

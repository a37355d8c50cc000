#include "sim_cuda/stability/hard_run.h"

#include "sim_cuda/run/run_state.h"

namespace collidoscope {
namespace {

template <class Value>
void set_if_planted(Value& value, const std::optional<Value>& planted) {
  if (planted) value = *planted;
}

void plant(World& world, const PlantedState& planted) {
  if (planted.body >= world.initial().size()) return;
  RunState state = world.state();
  set_if_planted(state.bodies.position[planted.body], planted.position);
  set_if_planted(state.bodies.velocity[planted.body], planted.velocity);
  set_if_planted(state.bodies.angular_velocity[planted.body], planted.angular_velocity);
  set_if_planted(state.bodies.orientation[planted.body], planted.orientation);
  world.adopt(state);
}

}  // namespace

HardRun::HardRun(Scene scene, RunOptions options, std::vector<Change> changes,
                 std::optional<PlantedState> planted)
    : changes_(std::move(changes)), planted_(std::move(planted)) {
  for (; next_ < changes_.size() && changes_[next_].step == 0 && changes_[next_].freeze.empty(); ++next_)
    make_change(changes_[next_], scene, options);
  world_ = std::make_unique<World>(scene, options);
  make_due();
}

void HardRun::step() {
  const std::int64_t before = state();
  world_->step();
  if (state() == before) return;  // guards pause: what is due here was made
  seconds_ += world_->scene().physics.time_step;
  make_due();
}

void HardRun::make_due() {
  for (; next_ < changes_.size() && changes_[next_].step == state(); ++next_)
    if (auto next = changed_world(*world_, changes_[next_], world_->options())) world_ = std::move(next);
  if (planted_ && planted_->step == state()) plant(*world_, *planted_);
}

}  // namespace collidoscope

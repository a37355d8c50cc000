#include "sim_cuda/run/rewind.h"

#include <stdexcept>

namespace collidoscope {

void Rewind::before_step(World& world) {
  constexpr int dear = 50;  // times as long as a copy takes, until the next
  const Clock::time_point now = Clock::now();
  if (going_back_ || (copy_ && now - made_ < dear * cost_)) return;
  copy_ = world.state();
  made_ = Clock::now();
  cost_ = made_ - now;
}

void Rewind::to(World& world, std::int64_t step) {
  if (!copy_ || step < copy_->steps)
    throw std::logic_error("rewind: state " + std::to_string(step) + " was not followed");
  struct UntilTheEnd {  // however it ends
    bool& on;
    ~UntilTheEnd() { on = false; }
  } back{going_back_};
  going_back_ = true;
  world.adopt(*copy_);
  world.step(static_cast<int>(step - copy_->steps));
}

void Rewind::forget() {
  if (!going_back_) copy_.reset();
}

}  // namespace collidoscope

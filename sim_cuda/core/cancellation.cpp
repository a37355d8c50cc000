#include "sim_cuda/core/cancellation.h"

#include <utility>

namespace collidoscope {

void Cancellation::set_poll(std::function<void()> poll, Clock::duration interval) {
  poll_ = std::move(poll);
  poller_ = std::this_thread::get_id();
  interval_ = interval;
  next_ = {};
}

bool Cancellation::poll() {
  if (!requested() && poll_ && std::this_thread::get_id() == poller_) {
    const Clock::time_point now = Clock::now();
    if (now >= next_) {
      poll_();
      next_ = Clock::now() + interval_;
    }
  }
  return requested() && !suspended_.load(std::memory_order_relaxed);
}

}  // namespace collidoscope

#pragma once
// A request to end long work before it is done. Worlds that were made with one
// (ExecutorOptions::cancellation) look at it between stages, and on the CPU between chunks of a stage; once
// it is requested they throw Cancelled. A cancelled step commits nothing (World::step). Outlives those
// worlds.

#include <atomic>
#include <chrono>
#include <functional>
#include <thread>

namespace collidoscope {

/// What cancelled work throws. No std::exception: code that reports errors must not take it for one.
struct Cancelled {};

class Cancellation {
 public:
  using Clock = std::chrono::steady_clock;

  /// Any thread, or a signal handler.
  void request() noexcept { requested_.store(true, std::memory_order_relaxed); }
  bool requested() const noexcept { return requested_.load(std::memory_order_relaxed); }
  /// Outside of cancellable work: work may begin again.
  void clear() noexcept { requested_.store(false, std::memory_order_relaxed); }

  /// While suspended, poll() does not see the request.
  void suspend(bool on) noexcept { suspended_.store(on, std::memory_order_relaxed); }

  /// Calls `poll` on this thread while cancellable work runs on it, about once in each `interval`; 0: as
  /// often as the work looks. `poll` may call request(); it must not throw, and must not touch a World.
  void set_poll(std::function<void()> poll, Clock::duration interval = std::chrono::milliseconds(20));

  /// For cancellable work: polls if that is due, and says whether to end. Any thread.
  bool poll();

  /// s. Work that writes what it cannot undo is not interrupted where it is expected to take no longer;
  /// longer work first saves what it writes. 0 in tests: it always does.
  double uninterrupted = 0.2;

 private:
  static_assert(std::atomic<bool>::is_always_lock_free);
  std::atomic<bool> requested_ = false, suspended_ = false;
  std::function<void()> poll_;
  std::thread::id poller_;
  Clock::duration interval_{};
  Clock::time_point next_{};  ///< of poller_ alone
};

}  // namespace collidoscope

#pragma once
// Cooperative cancellation of long work. Set ExecutorOptions::cancellation to use it; the object must outlive
// the worlds made with it. Worlds check it between stages, and on the CPU between chunks of a stage. If it is
// requested, they throw Cancelled. A cancelled step commits nothing (World::step).

#include <atomic>
#include <chrono>
#include <functional>
#include <thread>

namespace collidoscope {

/// Thrown by cancelled work. Not a std::exception, so that error handlers do not report it.
struct Cancelled {};

class Cancellation {
 public:
  using Clock = std::chrono::steady_clock;

  /// Callable from any thread and from a signal handler. On a GPU, work in progress is abandoned, and its
  /// worlds cannot be used any more.
  void request() noexcept { set(true, false); }
  /// The same, but a GPU first completes the step in progress, and its worlds can continue.
  void request_between_steps() noexcept { set(true, true); }
  bool requested() const noexcept { return requested_.load(std::memory_order_acquire); }
  bool between_steps() const noexcept { return between_steps_.load(std::memory_order_relaxed); }
  /// Clears the request. Call outside of cancellable work.
  void clear() noexcept { set(false, false); }

  /// While suspended, poll() returns false.
  void suspend(bool on) noexcept { suspended_.store(on, std::memory_order_relaxed); }

  /// Calls `poll` on this thread during cancellable work, about once per `interval`; 0: at every check.
  /// `poll` may call request(). It must not throw, and must not access a World.
  void set_poll(std::function<void()> poll, Clock::duration interval = std::chrono::milliseconds(20));

  /// Called by cancellable work: runs the poll function if it is due, and returns whether to cancel. Any
  /// thread.
  bool poll();

  /// s. Work that cannot be undone is not interrupted if it is expected to take at most this time. Longer
  /// work first makes a backup of the data that it writes. Tests set 0: always a backup.
  double uninterrupted = 0.2;

 private:
  void set(bool requested, bool between_steps) noexcept {
    between_steps_.store(between_steps, std::memory_order_relaxed);
    requested_.store(requested, std::memory_order_release);
  }
  static_assert(std::atomic<bool>::is_always_lock_free);
  std::atomic<bool> requested_ = false, between_steps_ = false, suspended_ = false;
  std::function<void()> poll_;
  std::thread::id poller_;
  Clock::duration interval_{};
  Clock::time_point next_{};  ///< used by the thread poller_ only
};

}  // namespace collidoscope

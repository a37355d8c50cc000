#pragma once
// Makes the steps of a LiveWorld on a thread of its own, and publishes states for drawing.
//
// Either the thread or its owner uses the LiveWorld, never both. The owner has it at first, and start()
// passes it to the thread. The thread returns it when it pauses, which it does between two steps.

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "sim_cuda/run/break_conditions.h"
#include "viewer/session/live_breakpoints.h"
#include "viewer/session/live_world.h"
#include "viewer/view/published_state.h"

namespace collidoscope {

class SimulationThread {
 public:
  /// How the run continues. Can change while it runs.
  struct Plan {
    double speed = 1;      ///< simulated seconds per second; 0: one step per state that was taken
    bool at_once = false;  ///< does not wait for the time of a step
    bool publishes = true;
    std::optional<std::int64_t> pause_at;  ///< pauses at this state
    BreakConditions conditions;
    PublishRequest request;
  };
  /// Why the thread has paused, and what it did since start().
  struct Result {
    std::int64_t steps = 0;
    double simulated = 0;      ///< s
    bool stopped = false;      ///< by a guard or a condition: LiveBreakpoints::stop()
    bool reached = false;      ///< Plan::pause_at
    std::exception_ptr error;  ///< of a step; the world is in the state before it
    std::string notice;        ///< message for the user
  };

  /// Keeps references. `published`: called on the thread after each publication.
  SimulationThread(LiveWorld& live, LiveBreakpoints& breaks, std::function<void()> published);
  /// Waits for the end of the present step.
  ~SimulationThread();
  SimulationThread(const SimulationThread&) = delete;
  SimulationThread& operator=(const SimulationThread&) = delete;

  /// Makes steps from now on, at most `steps`, and at least one if it is due. Older published states can no
  /// longer be taken. Precondition: paused(). `before`: other work, done on the thread before the steps. If
  /// it returns false, no steps are made.
  void start(const Plan& plan, std::int64_t steps = std::numeric_limits<std::int64_t>::max(),
             std::function<bool()> before = nullptr);
  /// Changes the plan of the running thread.
  void update(const Plan& plan);
  /// Asks the thread to pause after the present step, and waits at most this long. Returns paused().
  bool pause(std::chrono::milliseconds wait);
  bool paused() const;
  /// Whether the thread is asked to pause. For long work in `before`.
  bool must_pause() const;
  /// The result since the last call. Precondition: paused().
  Result take_result();
  /// Exchanges `state` for the newest published state, if it was not taken yet. Any thread.
  bool take(std::unique_ptr<PublishedState>& state);
  /// Total simulated time of all steps, s. Any thread.
  double simulated() const;
  /// Whether the last steps took longer than Plan::speed allows. Any thread.
  bool behind() const;

 private:
  using Clock = std::chrono::steady_clock;
  void work();
  bool wait_until_due(std::unique_lock<std::mutex>& lock, bool first);
  void schedule(const Plan& plan, double time_step);
  bool publication_due(const Plan& plan, bool on_gpu) const;
  void publish(const PublishRequest& request);
  void run();

  LiveWorld& live_;
  LiveBreakpoints& breaks_;
  std::function<void()> published_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;  ///< of the following members
  bool running_ = false, pause_ = false, quit_ = false;
  Plan plan_;
  std::int64_t steps_left_ = 0;
  std::function<bool()> before_;
  Result result_;
  double simulated_ = 0;
  bool behind_ = false;
  std::unique_ptr<PublishedState> ready_;  ///< null: taken
  std::unique_ptr<PublishedState> spare_;  ///< its memory is used again

  // Used by the thread only.
  Clock::time_point due_, paused_at_;  ///< time of the next step; end of the last work()
  std::unique_ptr<PublishedState> next_;
  PublishRequest published_request_;  ///< of the last publication
  Clock::time_point published_at_;
  double publish_seconds_ = 0;
  std::thread thread_;  ///< last: the other members exist while it runs
};

}  // namespace collidoscope

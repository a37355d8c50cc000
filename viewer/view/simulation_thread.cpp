#include "viewer/view/simulation_thread.h"

#include <algorithm>
#include <utility>

#include "sim_cuda/core/cancellation.h"
#include "sim_cuda/core/compute_device.h"
#include "sim_cuda/core/wall_clock.h"

namespace collidoscope {
namespace {

/// Steps that are later than this are dropped.
constexpr std::chrono::milliseconds tolerance(100);

}  // namespace

SimulationThread::SimulationThread(LiveWorld& live, LiveBreakpoints& breaks, std::function<void()> published)
    : live_(live), breaks_(breaks), published_(std::move(published)), thread_([this] { run(); }) {}

SimulationThread::~SimulationThread() {
  {
    const std::lock_guard lock(mutex_);
    quit_ = pause_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void SimulationThread::start(const Plan& plan, std::int64_t steps, std::function<bool()> before) {
  {
    const std::lock_guard lock(mutex_);
    plan_ = plan;
    steps_left_ = steps;
    before_ = std::move(before);
    if (ready_) spare_ = std::move(ready_);
    pause_ = false;
    running_ = true;
  }
  changed_.notify_all();
}

void SimulationThread::update(const Plan& plan) {
  {
    const std::lock_guard lock(mutex_);
    if (plan_.speed == plan.speed && plan_.publishes == plan.publishes && plan_.pause_at == plan.pause_at &&
        plan_.conditions.limits == plan.conditions.limits && plan_.request == plan.request)
      return;
    plan_ = plan;
  }
  changed_.notify_all();
}

bool SimulationThread::pause(std::chrono::milliseconds wait) {
  std::unique_lock lock(mutex_);
  if (!running_) return true;
  pause_ = true;
  changed_.notify_all();
  return changed_.wait_for(lock, wait, [this] { return !running_; });
}

bool SimulationThread::paused() const {
  const std::lock_guard lock(mutex_);
  return !running_;
}

bool SimulationThread::must_pause() const {
  const std::lock_guard lock(mutex_);
  return pause_ || quit_;
}

SimulationThread::Result SimulationThread::take_result() {
  const std::lock_guard lock(mutex_);
  return std::exchange(result_, {});
}

bool SimulationThread::take(std::unique_ptr<PublishedState>& state) {
  {
    const std::lock_guard lock(mutex_);
    if (!ready_) return false;
    spare_ = std::exchange(state, std::move(ready_));
  }
  changed_.notify_all();
  return true;
}

double SimulationThread::simulated() const {
  const std::lock_guard lock(mutex_);
  return simulated_;
}

bool SimulationThread::behind() const {
  const std::lock_guard lock(mutex_);
  return running_ && behind_;
}

void SimulationThread::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return running_ || quit_; });
    if (quit_) return;
    lock.unlock();
    std::exception_ptr error;
    try {
      work();
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    if (error) result_.error = error;
    running_ = false;
    changed_.notify_all();
    if (published_) published_();
  }
}

/// Waits for the time of the next step. Returns false if the thread must pause. The first step after start()
/// is made if it is due, even if a pause is requested. Otherwise frequent pauses would stop the run.
bool SimulationThread::wait_until_due(std::unique_lock<std::mutex>& lock, bool first) {
  while (!quit_ && steps_left_ > 0) {
    const bool due = plan_.at_once || (plan_.speed > 0 ? Clock::now() >= due_ : !plan_.publishes || !ready_);
    if (due && (first || !pause_)) return true;
    if (pause_) return false;
    if (plan_.speed > 0)
      changed_.wait_until(lock, due_);
    else
      changed_.wait(lock);
  }
  return false;
}

/// Sets the time of the step after the present one.
void SimulationThread::schedule(const Plan& plan, double time_step) {
  if (plan.at_once || plan.speed == 0) return;
  using std::chrono::duration;
  const Clock::time_point now = Clock::now();
  due_ += std::chrono::duration_cast<Clock::duration>(duration<double>(time_step / plan.speed));
  const bool late = now - due_ > tolerance;
  if (late) due_ = now;
  const std::lock_guard lock(mutex_);
  behind_ = late || (behind_ && now > due_);
}

/// A publication takes as long as a part of a step. So it waits until it takes only a share of the time, but
/// not longer than half a second.
bool SimulationThread::publication_due(const Plan& plan, bool on_gpu) const {
  {
    const std::lock_guard lock(mutex_);
    if (!plan.publishes || ready_) return false;
  }
  if (plan.speed == 0 || plan.request != published_request_) return true;
  const double share = on_gpu ? 0.03 : 0.12;
  const double since = seconds_since(published_at_);
  return since >= std::min(publish_seconds_ / share, 0.5);
}

void SimulationThread::publish(const PublishRequest& request) {
  const Clock::time_point start = Clock::now();
  if (!next_) {
    const std::lock_guard lock(mutex_);
    next_ = std::move(spare_);
  }
  if (!next_) next_ = std::make_unique<PublishedState>();
  publish_state(live_, request, nullptr, *next_);
  published_request_ = request;
  {
    const std::lock_guard lock(mutex_);
    ready_ = std::move(next_);
  }
  published_at_ = Clock::now();
  publish_seconds_ = std::chrono::duration<double>(published_at_ - start).count() + live_.measure_seconds();
  if (published_) published_();
}

void SimulationThread::work() {
  int device = live_.world().info().gpu, generation = live_.generation();
  use_device_on_this_thread(device);
  if (const auto before = std::exchange(before_, nullptr); before && !before()) return;
  // After a short pause, the pace is kept. After a longer one, the first step is made at once.
  const Clock::time_point now = Clock::now();
  if (now - paused_at_ > tolerance) due_ = now;
  struct NotePause {
    Clock::time_point& paused_at;
    ~NotePause() { paused_at = Clock::now(); }
  } note_pause{paused_at_};
  for (bool first = true;; first = false) {
    Plan plan;
    {
      std::unique_lock lock(mutex_);
      if (!wait_until_due(lock, first)) return;
      plan = plan_;
      --steps_left_;
    }
    World& world = live_.world();
    if (generation != live_.generation()) {  // by other work, or by a change of a script
      generation = live_.generation();
      device = world.info().gpu;
      use_device_on_this_thread(device);
    }
    world.records().record_impulses(plan.request.impulses);
    world.records().record_residuals(plan.request.residuals);
    const double time_step = world.scene().physics.time_step;
    schedule(plan, time_step);
    const std::size_t frozen = world.validation().frozen().size();
    breaks_.before_step(live_, plan.conditions);
    const bool publishes = publication_due(plan, device >= 0);
    const bool stepped = live_.step(plan.conditions.any() || publishes || !behind());
    const bool stopped = breaks_.after_step(live_, plan.conditions);
    const bool reached = stepped && plan.pause_at && live_.world().steps() == *plan.pause_at;
    const StateValidation& validation = live_.world().validation();
    {
      const std::lock_guard lock(mutex_);
      result_.steps += stepped;
      result_.simulated += stepped ? time_step : 0;
      simulated_ += stepped ? time_step : 0;
      if (!stopped && validation.frozen().size() > frozen && validation.finding())
        result_.notice = "frozen: " + describe(*validation.finding());
      result_.stopped |= stopped;
      result_.reached |= reached;
      if (stopped || reached || !stepped) return;
    }
    if (publishes) publish(plan.request);
  }
}

}  // namespace collidoscope

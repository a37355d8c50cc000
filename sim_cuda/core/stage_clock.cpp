#include "sim_cuda/core/stage_clock.h"

#include <algorithm>

#include "sim_cuda/core/statistics.h"

namespace collidoscope {

void TimeSamples::add(float milliseconds) {
  last_ = milliseconds;
  if (recent_.size() < capacity)
    recent_.push_back(milliseconds);
  else
    recent_[static_cast<std::size_t>(count_) % capacity] = milliseconds;
  ++count_;
}

StageClock::Entry& StageClock::entry(const char* name) {
  for (Entry& e : entries_)
    if (e.name == name) return e;
  entries_.emplace_back();
  entries_.back().name = name;
  return entries_.back();
}

void StageClock::commit_step() {
  for (Entry& e : entries_) {
    e.samples_ms.add(e.step_ms);
    e.step_ms = 0;
  }
}

std::vector<StageTime> StageClock::step_in_progress() const {
  std::vector<StageTime> stages;
  for (const Entry& e : entries_) {
    if (!(e.step_ms > 0)) continue;
    StageTime& stage = stages.emplace_back();
    stage.name = e.name;
    stage.last_ms = static_cast<double>(e.step_ms);
    stage.launches = e.launches;
    stage.library_launch = e.library_launch;
  }
  return stages;
}

void StageClock::discard_step() {
  for (Entry& e : entries_) e.step_ms = 0;
}

void StageClock::clear_launches() {
  for (Entry& e : entries_) e.launches = 0;
}

void StageClock::add_launch(std::size_t index, const StageLaunch& launch) {
  StageLaunch& kept = entries_[index].launch;
  if (kept.threads == 0 || launch.items > kept.items) kept = launch;
}

void StageClock::clear_shapes() {
  for (Entry& e : entries_) e.launch = {};
}

RunTimes StageClock::times() const {
  RunTimes times;
  times.steps_timed = static_cast<int>(plain_ms_.count());
  times.step_median_ms = quantile(plain_ms_.recent(), 0.5);
  times.step_p95_ms = quantile(plain_ms_.recent(), 0.95);
  times.step_last_ms = plain_ms_.last();
  for (const Entry& e : entries_)
    times.stages.push_back({e.name, quantile(e.samples_ms.recent(), 0.5),
                            quantile(e.samples_ms.recent(), 0.95), e.samples_ms.last(), e.launches,
                            e.library_launch, e.launch, static_cast<int>(e.samples_ms.count())});
  return times;
}

RunTimes StageClock::latest() const {
  RunTimes times;
  times.steps_timed = static_cast<int>(plain_ms_.count());
  times.step_last_ms = plain_ms_.last();
  for (const Entry& e : entries_)
    times.stages.push_back({e.name, 0, 0, e.samples_ms.last(), e.launches, e.library_launch, e.launch,
                            static_cast<int>(e.samples_ms.count())});
  return times;
}

}  // namespace collidoscope

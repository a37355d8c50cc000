#include "sim_cuda/recording/timeline.h"

#include <fmt/format.h>
#include <sys/sysinfo.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/wall_clock.h"

namespace collidoscope {
namespace {

template <class Item>
std::int64_t list_bytes(const std::vector<Item>& list) {
  return static_cast<std::int64_t>(list.size() * sizeof(Item));
}

std::int64_t bytes_of_state(const RunState& state) {
  const WarmStart& warm_start = state.warm_start;
  std::int64_t walls = 0;
  for (const auto& wall : warm_start.walls) walls += list_bytes(wall);
  const BodyStates& bodies = state.bodies;
  return list_bytes(bodies.position) + list_bytes(bodies.velocity) + list_bytes(bodies.angular_velocity) +
         list_bytes(bodies.orientation) + list_bytes(state.static_impulses) + list_bytes(state.frozen) +
         list_bytes(warm_start.contacts) + walls + list_bytes(warm_start.friction) +
         list_bytes(warm_start.wall_friction) + list_bytes(warm_start.rolling) +
         list_bytes(warm_start.wall_rolling) + list_bytes(warm_start.sleep_timer) +
         list_bytes(warm_start.joints) + list_bytes(warm_start.loop_energies);
}

}  // namespace

std::int64_t Timeline::default_budget() {
  constexpr std::int64_t most = std::int64_t{1} << 30;
  struct sysinfo info {};
  if (sysinfo(&info) != 0) return most / 4;
  return std::min(most, static_cast<std::int64_t>(info.freeram + info.bufferram) * info.mem_unit / 4);
}

Timeline::Timeline(std::int64_t budget) : budget_(budget) {}

void Timeline::begin(World& world) {
  keyframes_.clear();
  trail_.clear();
  hashes_.clear();
  bytes_ = 0;
  interval_ = keyframe_seconds;
  add(keyframe_of(world, true));
}

Timeline::Keyframe Timeline::keyframe_of(World& world, bool is_change) {
  const auto start = std::chrono::steady_clock::now();
  Keyframe keyframe{std::make_shared<const SavedRun>(save_run(world)), 0, is_change};
  keyframe.bytes = bytes_of_state(keyframe.saved->state);
  cost_ = seconds_since(start);
  return keyframe;
}

void Timeline::add(Keyframe keyframe) {
  bytes_ += keyframe.bytes;
  keyframes_.push_back(std::move(keyframe));
  seconds_ = 0;
  fit_budget();
}

void Timeline::set_budget(std::int64_t budget) {
  budget_ = budget;
  fit_budget();
}

void Timeline::fit_budget() {
  while (bytes_ > budget_ && keyframes_.size() > 1)
    if (std::ranges::count(keyframes_, false, &Keyframe::is_change) > 1)
      thin_out();
    else
      forget_oldest();
}

void Timeline::forget_oldest() {
  const std::int64_t before = first();
  bytes_ -= keyframes_.front().bytes;
  keyframes_.erase(keyframes_.begin());
  keyframes_.front().is_change = true;
  hashes_.erase(hashes_.begin(), hashes_.begin() + (first() - before));
}

/// Removes every second keyframe that is not needed, and doubles the interval of further ones.
void Timeline::thin_out() {
  bool keep = false;
  std::erase_if(keyframes_, [&](const Keyframe& keyframe) {
    if (keyframe.is_change) return false;
    keep = !keep;
    if (!keep) bytes_ -= keyframe.bytes;
    return !keep;
  });
  interval_ *= 2;
}

void Timeline::record_step(World& world, double seconds) {
  hashes_.push_back(world.state_hash());
  seconds_ += seconds;
  constexpr double most = 0.1;  // share of the time
  if (seconds_ >= std::max(interval_, cost_ / most)) add(keyframe_of(world, false));
}

void Timeline::record_change(World& world) {
  trail_.clear();
  Keyframe keyframe = keyframe_of(world, true);
  // The state before the change cannot be reached any more.
  while (!keyframes_.empty() && keyframes_.back().state() == world.steps()) {
    bytes_ -= keyframes_.back().bytes;
    keyframes_.pop_back();
  }
  add(std::move(keyframe));
}

void Timeline::forget_after(std::int64_t step) {
  trail_.clear();
  hashes_.resize(static_cast<std::size_t>(step - first()));
  while (keyframes_.back().state() > step) {
    bytes_ -= keyframes_.back().bytes;
    keyframes_.pop_back();
  }
  seconds_ = 0;
}

std::vector<std::int64_t> Timeline::changes() const {
  std::vector<std::int64_t> steps;
  for (std::size_t k = 1; k < keyframes_.size(); ++k)
    if (keyframes_[k].is_change) steps.push_back(keyframes_[k].state());
  return steps;
}

std::vector<Timeline::Keyframe>::const_iterator Timeline::keyframe_at_or_before(std::int64_t step) const {
  const auto after = std::ranges::upper_bound(keyframes_, step, {},
                                              [](const Keyframe& keyframe) { return keyframe.state(); });
  return after - 1;
}

bool Timeline::is_change(std::int64_t step) const {
  const Keyframe& keyframe = *keyframe_at_or_before(step);
  return step > first() && keyframe.is_change && keyframe.state() == step;
}

std::unique_ptr<World> Timeline::world_at(std::int64_t step, const RunOptions& options) {
  const Keyframe& keyframe = *keyframe_at_or_before(step);
  std::shared_ptr<const SavedRun> from = keyframe.saved;
  // A trail does not cross a change, since changes are keyframes.
  for (const auto& saved : trail_)
    if (saved->state.steps > from->state.steps && saved->state.steps <= step) from = saved;
  constexpr std::int64_t near = 8;
  const bool descends = step < reached_ && reached_ - step <= near;
  auto world = std::make_unique<World>(from->scene, options, &from->state);
  const std::int64_t most =
      std::clamp<std::int64_t>(budget_ / 10 / std::max<std::int64_t>(keyframe.bytes, 1), 2, 100);
  std::vector<std::shared_ptr<const SavedRun>> trail;
  // Up to the requested state, or to the first one that is kept.
  if (const std::int64_t to = descends ? step - most : step; world->steps() < to) {
    world->step(static_cast<int>(to - world->steps()));
    check(*world);
  }
  while (world->steps() < step) {
    trail.push_back(std::make_shared<const SavedRun>(save_run(*world)));
    world->step();
    check(*world);
  }
  if (!trail.empty())
    trail_ = std::move(trail);
  else if (!descends)
    trail_.clear();
  reached_ = step;
  return world;
}

void Timeline::check(World& world) const {
  const std::uint64_t recorded = hashes_[static_cast<std::size_t>(world.steps() - first() - 1)];
  const std::uint64_t actual = world.state_hash();
  if (recorded != actual)
    throw MachineError(fmt::format("state {} reached again has the hash {:016x}, before {:016x}",
                                   world.steps(), actual, recorded));
}

}  // namespace collidoscope

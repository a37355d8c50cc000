#include "sim_cuda/recording/timeline.h"

#include <fmt/format.h>
#include <sys/sysinfo.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/wall_clock.h"

namespace collidoscope {

std::int64_t Timeline::default_budget() {
  constexpr std::int64_t most = std::int64_t{1} << 30;
  struct sysinfo info {};
  if (sysinfo(&info) != 0) return most / 4;
  return std::min(most, static_cast<std::int64_t>(info.freeram + info.bufferram) * info.mem_unit / 4);
}

Timeline::Timeline(std::int64_t budget) : budget_(budget) {}

void Timeline::begin(World& world) { begin(Kept(*keyframe_of(world, true).kept)); }

void Timeline::begin(Kept first) {
  packing_ = {};
  keyframes_.clear();
  trail_.clear();
  hashes_.clear();
  bytes_ = 0;
  interval_ = keyframe_seconds;
  add({std::make_shared<const Kept>(std::move(first)), true});
}

Timeline::Keyframe Timeline::keyframe_of(World& world, bool is_change) {
  const auto start = std::chrono::steady_clock::now();
  // Scenes with many bodies are large. Only a change replaces the scene.
  const auto scene = is_change ? std::make_shared<const Scene>(world.scene()) : keyframes_.back().kept->scene;
  Keyframe keyframe{
      std::make_shared<const Kept>(Kept{scene, CompactState(world.state()), world.state_hash()}), is_change};
  cost_ = seconds_since(start);
  return keyframe;
}

/// Adds a keyframe of the last state, now or when another thread has packed it.
void Timeline::begin_keyframe(World& world) {
  end_keyframe();
  // On the CPU, another thread would take time from the simulation.
  if (!world.info().on_gpu) return add(keyframe_of(world, false));
  const auto start = std::chrono::steady_clock::now();
  packing_ =
      std::async(std::launch::async, [scene = keyframes_.back().kept->scene, copied = world.copy_state(),
                                      hash = world.hashes().bodies]() mutable {
        return Keyframe{std::make_shared<const Kept>(Kept{scene, CompactState(copied.complete()), hash}),
                        false};
      }).share();
  seconds_ = 0;
  cost_ = seconds_since(start);
}

/// Waits for the keyframe that another thread packs, if any, and adds it.
void Timeline::end_keyframe() {
  if (!packing_.valid()) return;
  const double seconds = seconds_;
  add(std::exchange(packing_, {}).get());
  seconds_ = seconds;
}

void Timeline::add(Keyframe keyframe) {
  end_keyframe();
  // The state before a change cannot be reached any more.
  while (!keyframes_.empty() && keyframes_.back().state() == keyframe.state()) {
    keyframe.is_change |= keyframes_.back().is_change;
    bytes_ -= keyframes_.back().bytes();
    keyframes_.pop_back();
  }
  bytes_ += keyframe.bytes();
  keyframes_.push_back(std::move(keyframe));
  seconds_ = 0;
  fit_budget();
}

void Timeline::set_budget(std::int64_t budget) {
  end_keyframe();
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
  bytes_ -= keyframes_.front().bytes();
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
    if (!keep) bytes_ -= keyframe.bytes();
    return !keep;
  });
  interval_ *= 2;
}

void Timeline::record_step(World& world, double seconds) {
  world.records().record_hashes(true);
  hashes_.push_back(world.hashes());
  seconds_ += seconds;
  if (packing_.valid() && packing_.wait_for(std::chrono::seconds(0)) == std::future_status::ready)
    end_keyframe();
  constexpr double most = 0.05;  // share of the time
  if (seconds_ >= std::max(interval_, cost_ / most)) begin_keyframe(world);
}

void Timeline::record_change(World& world) {
  end_keyframe();
  trail_.clear();
  add(keyframe_of(world, true));
}

void Timeline::forget_after(std::int64_t step) {
  end_keyframe();
  trail_.clear();
  hashes_.resize(static_cast<std::size_t>(step - first()));
  while (keyframes_.back().state() > step) {
    bytes_ -= keyframes_.back().bytes();
    keyframes_.pop_back();
  }
  seconds_ = 0;
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
  end_keyframe();
  const Keyframe& keyframe = *keyframe_at_or_before(step);
  std::shared_ptr<const Kept> from = keyframe.kept;
  // A trail does not cross a change, since changes are keyframes.
  for (const auto& kept : trail_)
    if (kept->state.steps() > from->state.steps() && kept->state.steps() <= step) from = kept;
  constexpr std::int64_t near = 8;
  const bool descends = step < reached_ && reached_ - step <= near;
  const RunState start = from->state.state();
  Scene scene = *from->scene;
  disable_guards(scene.physics);  // bodies that they froze are in the keyframe of that state
  auto world = std::make_unique<World>(scene, options, &start);
  const std::int64_t most =
      std::clamp<std::int64_t>(budget_ / 10 / std::max<std::int64_t>(keyframe.bytes(), 1), 2, 100);
  std::vector<std::shared_ptr<const Kept>> trail;
  // Up to the requested state, or to the first one that is kept.
  if (const std::int64_t to = descends ? step - most : step; world->steps() < to) {
    world->step(static_cast<int>(to - world->steps()));
    check(*world);
  }
  while (world->steps() < step) {
    trail.push_back(
        std::make_shared<const Kept>(Kept{from->scene, CompactState(world->state()), world->state_hash()}));
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

/// How the state of the world differs from the recorded one.
std::optional<std::string> Timeline::difference(World& world) const {
  const StateHashes& before = hashes_[static_cast<std::size_t>(world.steps() - first() - 1)];
  const StateHashes now = world.hashes();
  if (now.bodies != before.bodies)
    return fmt::format("the hash {:016x}, before {:016x}", now.bodies, before.bodies);
  if (before.full != 0 && now.full != before.full)
    return fmt::format("the hash {:016x} with warm-start data, before {:016x}", now.full, before.full);
  return std::nullopt;
}

bool Timeline::agrees(World& world) const { return !difference(world); }

void Timeline::check(World& world) const {
  if (const auto found = difference(world))
    throw MachineError(fmt::format("state {} reached again has {}", world.steps(), *found));
}

}  // namespace collidoscope

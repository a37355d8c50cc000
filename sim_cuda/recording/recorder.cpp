#include "sim_cuda/recording/recorder.h"

#include "sim_cuda/core/wall_clock.h"
#include "sim_cuda/recording/recording_chunks.h"
#include "sim_cuda/run/run_state.h"

namespace collidoscope {
namespace {

/// A kill loses at most the hashes of this time, s.
constexpr double longest_hash_delay = 0.25;

}  // namespace

void Recorder::begin(World& world) {
  write_meta_chunk(writer_, world);
  write_keyframe(world);
}

void Recorder::write_keyframe(World& world) {
  write_hashes();
  const Clock::time_point start = Clock::now();
  write_keyframe_chunk(writer_, snapshot_of(world));
  keyframe_step_ = first_ = world.steps();
  keyframe_seconds_ = seconds_since(start);
  since_keyframe_ = since_written_ = Clock::now();
}

void Recorder::write_hashes() {
  if (hashes_.empty()) return;
  write_hashes_chunk(writer_, first_, hashes_);
  first_ += std::ssize(hashes_);
  hashes_.clear();
  since_written_ = Clock::now();
}

void Recorder::record_step(World& world) {
  world.records().record_hashes(true);
  hashes_.push_back(world.hashes());
  if (world.steps() - keyframe_step_ >= min_keyframe_steps &&
      seconds_since(since_keyframe_) > 10 * keyframe_seconds_)
    return write_keyframe(world);
  if (seconds_since(since_written_) > longest_hash_delay) write_hashes();
}

void Recorder::record_change(World& world, const Change& change, const Scene& before) {
  write_hashes();
  write_change_chunk(writer_, change, before);
  write_keyframe(world);
}

void Recorder::end(World& world) {
  if (world.steps() != keyframe_step_ || !hashes_.empty()) write_keyframe(world);
  writer_.write(chunk_types::end, "");
}

}  // namespace collidoscope

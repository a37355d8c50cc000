#include "sim_cuda/recording/recorder.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "sim_cuda/changes/changes_file.h"
#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/core/wall_clock.h"
#include "sim_cuda/run/run_state.h"

namespace collidoscope {
namespace {

/// A kill loses at most the hashes of this time, s.
constexpr double longest_hash_delay = 0.25;

std::string_view bytes_of_number(const std::int64_t& number) {
  return {reinterpret_cast<const char*>(&number), sizeof number};
}

std::string recording_meta(World& world) {
  const WorldInfo info = world.info();
  nlohmann::ordered_json meta;
  meta["program"] = "collidoscope";
  meta["physics_version"] = physics_version;
  meta["scene"] = world.scene().name;
  meta["executor"] = info.on_gpu ? "cuda" : "cpu";
  meta["device"] = info.device_name;
  meta["broad_phase"] = world.options().broad_phase;
  return meta.dump();
}

}  // namespace

void Recorder::begin(World& world) {
  writer_.write(chunk_types::meta, recording_meta(world));
  write_keyframe(world);
}

void Recorder::write_keyframe(World& world) {
  write_hashes();
  const Clock::time_point start = Clock::now();
  const Snapshot snapshot = snapshot_of(world);
  writer_.write(chunk_types::keyframe, [&](const RecordingWriter::Sink& sink) {
    sink(bytes_of_number(snapshot.state.steps));
    sink(bytes_of_number(static_cast<std::int64_t>(full_hash(snapshot.state))));
    write_snapshot(snapshot, sink);
  });
  keyframe_step_ = first_ = world.steps();
  keyframe_seconds_ = seconds_since(start);
  since_keyframe_ = since_written_ = Clock::now();
}

void Recorder::write_hashes() {
  if (hashes_.empty()) return;
  writer_.write(chunk_types::hashes, [&](const RecordingWriter::Sink& sink) {
    sink(bytes_of_number(first_));
    sink({reinterpret_cast<const char*>(hashes_.data()), hashes_.size() * sizeof(RecordedHash)});
  });
  first_ += std::ssize(hashes_);
  hashes_.clear();
  since_written_ = Clock::now();
}

void Recorder::record_step(World& world) {
  // On a GPU, copying the state of each step would take longer than the step.
  hashes_.push_back({world.state_hash(), world.info().on_gpu ? 0 : full_hash(world.state())});
  if (world.steps() - keyframe_step_ >= min_keyframe_steps &&
      seconds_since(since_keyframe_) > 10 * keyframe_seconds_)
    return write_keyframe(world);
  if (seconds_since(since_written_) > longest_hash_delay) write_hashes();
}

void Recorder::record_change(World& world, const Change& change, const Scene& before) {
  write_hashes();
  const std::string text = write_changes({{change}, std::nullopt}, before);
  writer_.write(chunk_types::change, std::string(bytes_of_number(change.step)) + text);
  write_keyframe(world);
}

void Recorder::end(World& world) {
  if (world.steps() != keyframe_step_ || !hashes_.empty()) write_keyframe(world);
  writer_.write(chunk_types::end, "");
}

}  // namespace collidoscope

#pragma once
// Records a run into a file: its start, its changes, a hash of every state, and keyframes.

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "sim_cuda/changes/changes.h"
#include "sim_cuda/recording/recording_file.h"
#include "sim_cuda/world.h"

namespace collidoscope {

class Recorder {
 public:
  /// Opens the file. Throws InputError. All other members throw MachineError if it cannot be written.
  explicit Recorder(const std::string& file) : writer_(file) {}

  /// Records the state of the world as the first keyframe.
  void begin(World& world);
  /// Call after each single step.
  void record_step(World& world);
  /// Call after a change was made in `world`. `before`: the scene before it.
  void record_change(World& world, const Change& change, const Scene& before);
  /// Records the last state as a keyframe.
  void end(World& world);

  /// Keyframes are at least so many steps apart, and so far that they take less than a tenth of the time.
  static constexpr std::int64_t min_keyframe_steps = 100;

 private:
  using Clock = std::chrono::steady_clock;
  void write_keyframe(World& world);
  void write_hashes();

  RecordingWriter writer_;
  std::vector<StateHashes> hashes_;  ///< not written yet
  std::int64_t first_ = 0;           ///< state before the first of `hashes_`
  std::int64_t keyframe_step_ = 0;   ///< of the last keyframe
  double keyframe_seconds_ = 0;      ///< that it took
  Clock::time_point since_keyframe_, since_written_;
};

}  // namespace collidoscope

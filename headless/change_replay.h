#pragma once
// Applies the changes of `run --changes` when the run reaches their states.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "headless/cli/command_line.h"
#include "sim_cuda/changes/changes_file.h"
#include "sim_cuda/recording/recorder.h"
#include "sim_cuda/world.h"

namespace collidoscope {

class ChangeReplay {
 public:
  /// Reads and validates the file; "" means no changes. Applies the changes of state 0 to `start`, which is
  /// then at state 0, and to `options`. Throws InputError.
  ChangeReplay(const std::string& file, Start& start, RunOptions& options);

  /// Number of steps until the next change.
  std::int64_t steps_to_next(const World& world) const;
  /// Applies the changes of the world's current state, and records them. Returns true if there were any.
  /// Throws the same exceptions as World.
  bool make_due(World& world, Recorder* recorder = nullptr);
  std::size_t left() const { return list_.changes.size() - next_; }  ///< changes not applied yet
  const std::optional<RecordedEnd>& end() const { return list_.end; }

 private:
  ChangeList list_;
  std::size_t next_ = 0;
};

}  // namespace collidoscope

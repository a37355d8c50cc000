#pragma once
// The changes of `run --changes`, made as the run comes to their states.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "headless/cli/command_line.h"
#include "sim_cuda/changes/changes_file.h"
#include "sim_cuda/world.h"

namespace collidoscope {

class Replay {
 public:
  /// Reads the file and tries all of it; "" has no changes. Those of state 0 go into `start`, which then is
  /// at that state, and `options`. Throws InputError.
  Replay(const std::string& file, Start& start, RunOptions& options);

  /// Steps that can be made before the next change.
  std::int64_t steps_to_next(const World& world) const;
  /// Makes the changes of the state that the world is in; whether there were any. Throws as World does.
  bool make_due(World& world);
  std::size_t left() const { return list_.changes.size() - next_; }  ///< not made yet
  const std::optional<RecordedEnd>& end() const { return list_.end; }

 private:
  ChangeList list_;
  std::size_t next_ = 0;
};

}  // namespace collidoscope

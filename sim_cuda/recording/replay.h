#pragma once
// Simulates a recorded run again and compares every state with the recording.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "sim_cuda/recording/recording_file.h"
#include "sim_cuda/scene/run_options.h"

namespace collidoscope {

struct ReplayResult {
  std::int64_t states = 0, changes = 0, keyframes = 0;  ///< that agree
  /// The first state that differs: "file: byte N: state 12: recorded hash ..., actual hash ...".
  std::optional<std::string> difference;
};

/// `options`: where the run is simulated. Changes of the execution in the recording have no effect. `done` is
/// called with the number of compared states. Throws InputError if the recording is damaged, MachineError
/// if its physics version is another one, and as World does.
ReplayResult replay(const RecordingReader& recording, const RunOptions& options,
                    const std::function<void(std::int64_t)>& done);

}  // namespace collidoscope

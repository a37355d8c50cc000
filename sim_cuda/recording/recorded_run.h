#pragma once
// A run in memory, with its timeline and its changes, to and from a recording.

#include <string>
#include <vector>

#include "sim_cuda/changes/changes.h"
#include "sim_cuda/recording/recording_file.h"
#include "sim_cuda/recording/timeline.h"
#include "sim_cuda/world.h"

namespace collidoscope {

struct RecordedRun {
  Timeline timeline;
  std::vector<Change> changes;  ///< after the first state, ascending
};

/// Reads the states of a recording within the budget of a timeline. Throws InputError. Precondition: the
/// recording has this program's physics version; otherwise its states cannot be reached again.
RecordedRun read_run(const RecordingReader& recording);

/// Writes a recording of all states of the timeline. `changes`: ascending; those up to the first state, and
/// those of the execution, are left out. `world`: at any state; the last state becomes a keyframe if it is
/// there, with its guards. Other keyframes have none: bodies that guards froze are changes. The file exists
/// only when it is complete. Throws MachineError, and Cancelled as its options ask.
void write_run(const std::string& file, const Timeline& timeline, const std::vector<Change>& changes,
               World& world);

}  // namespace collidoscope

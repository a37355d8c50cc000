#pragma once
// Files of changes: JSON with comments, `"format": "collidoscope-changes", "version": 1`. The README.md of
// this folder lists the members of a change. Free functions over plain data.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/changes/changes.h"
#include "sim_cuda/core/physics_version.h"

namespace collidoscope {

/// Last state of a recorded run.
struct RecordedEnd {
  std::int64_t step = 0;
  std::uint64_t state_hash = 0;
  int physics_version = collidoscope::physics_version;  ///< of the program that recorded it
};

struct ChangeList {
  std::vector<Change> changes;  ///< in ascending order of steps
  std::optional<RecordedEnd> end;
};

/// Reads a file and applies every change to a copy of `scene`, which is at state `start`. So all faults are
/// found before the simulation. A change of state 0 restarts the run. Throws InputError with one line per
/// fault: `file:line:column: what, and what would be right`.
ChangeList read_changes(const std::string& file, const Scene& scene, const RunOptions& options,
                        std::int64_t start);
/// The same from text; `name` replaces the file name in messages.
ChangeList parse_changes(std::string text, const std::string& name, const Scene& scene,
                         const RunOptions& options, std::int64_t start);

/// Formats the list as a file. `scene` contains the materials of added bodies. Reading the file gives the
/// same list bit for bit.
std::string write_changes(const ChangeList& list, const Scene& scene);

}  // namespace collidoscope

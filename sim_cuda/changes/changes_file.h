#pragma once
// Files of changes: JSON with comments, `"format": "collidoscope-changes", "version": 1`. README.md of
// this folder lists what a change may hold. Free functions over plain data.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/changes/changes.h"

namespace collidoscope {

/// Where a recorded run stood when it was written down.
struct RecordedEnd {
  std::int64_t step = 0;
  std::uint64_t state_hash = 0;
};

struct ChangeList {
  std::vector<Change> changes;  ///< steps ascending
  std::optional<RecordedEnd> end;
};

/// Reads, and tries every change on `scene`, which is at state `start`, so that all faults are known before
/// anything is simulated; a change of state 0 begins the run anew, wherever it is. Throws InputError with one
/// line per fault, `file:line:column: what, and what would be right`.
ChangeList read_changes(const std::string& file, const Scene& scene, const RunOptions& options,
                        std::int64_t start);
/// The same from text; `name` stands where the file would.
ChangeList parse_changes(std::string text, const std::string& name, const Scene& scene,
                         const RunOptions& options, std::int64_t start);

/// The list as a file. `scene` has the materials that bodies name. Reading it gives the same, bit for bit.
std::string write_changes(const ChangeList& list, const Scene& scene);

}  // namespace collidoscope

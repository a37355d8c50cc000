#pragma once
// A run whose bodies follow the frames of files.

#include <vector>

#include "sim_cuda/import/body_table.h"
#include "sim_cuda/recording/recorded_run.h"

namespace collidoscope {

/// Places the bodies of frame k; the world is then at state k. Precondition: the world has as many bodies.
void go_to_frame(World& world, const std::vector<BodyTable>& frames, std::size_t k);

/// State k of the run is frame k. Every state is stored, so nothing is simulated between them. `world` has
/// the bodies of the first frame, and is at state 0 before and after. All frames have as many bodies. Throws
/// Cancelled as its options ask.
RecordedRun run_of_frames(World& world, const std::vector<BodyTable>& frames);

}  // namespace collidoscope

#pragma once
// Writes the chunks of a recording. README.md describes their contents. Free functions, which throw as
// RecordingWriter::write().

#include <cstdint>
#include <span>

#include "sim_cuda/changes/changes.h"
#include "sim_cuda/recording/recording_file.h"
#include "sim_cuda/world.h"

namespace collidoscope {

void write_meta_chunk(RecordingWriter& writer, const World& world);
void write_keyframe_chunk(RecordingWriter& writer, const Snapshot& snapshot);
/// Hashes of the states after `first`.
void write_hashes_chunk(RecordingWriter& writer, std::int64_t first, std::span<const StateHashes> hashes);
/// `before`: the scene before the change.
void write_change_chunk(RecordingWriter& writer, const Change& change, const Scene& before);

}  // namespace collidoscope

#pragma once
// Snapshots: a run in a file, to go on from there bit for bit. Free functions; a Snapshot is plain data.
//
// The file is binary, little-endian, in pieces of whole 8 bytes: the line "collidoscope-snapshot", the
// version of the format, a mark of the byte order, the size of the file; the scene as a scene file's text;
// lists, each behind its length; and last a hash over all that. Numbers are doubles, whatever the precision
// of the run. It is written piece by piece, so that whoever writes it can put it in place as a whole.

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "sim_cuda/run/run_state.h"
#include "sim_cuda/scene/scene.h"
#include "sim_cuda/world.h"

namespace collidoscope {

/// Of the format; it grows with every change of what a file holds, or of what it means. 2: the ids of frozen
/// bodies come after the rest. 3: the simulated time comes last. Files of versions 1 and 2 are read.
inline constexpr std::uint32_t snapshot_version = 3, oldest_snapshot_version = 1;

struct Snapshot {
  Scene scene;
  RunState state;
  std::uint64_t state_hash = 0;   ///< World::state_hash() of the state
  std::uint64_t bodies_hash = 0;  ///< hash_of_bodies() of its scene
};

/// Of what never changes about bodies: radii, masses, inertia.
std::uint64_t hash_of_bodies(const InitialBodies& bodies);

Snapshot snapshot_of(World& world);

/// Gives the file's bytes to `write`, in order.
void write_snapshot(const Snapshot& snapshot, const std::function<void(std::string_view)>& write);

/// Checks everything before it believes anything: kind, version, size, hash, and each list against what the
/// file has room for, before memory is taken. Throws InputError, one line that begins with the file's name.
Snapshot read_snapshot(const std::string& file);

/// The run goes on: in the snapshot's own scene, bit for bit, or in `scene`, one that was made of it by
/// turning settings, as World::restore() does it. Throws as World does, and InputError where the scene is the
/// same, but its bodies are not (a mesh file that has changed).
World world_from(const Snapshot& snapshot, const Scene& scene, const RunOptions& options);

}  // namespace collidoscope

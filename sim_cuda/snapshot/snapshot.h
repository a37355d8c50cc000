#pragma once
// Snapshots: a run in a file, which continues bit for bit. Free functions; a Snapshot is plain data.
//
// Format: binary, little-endian, in units of 8 bytes. Header: the line "collidoscope-snapshot", format
// version, byte-order mark, file size. Then the scene as text of a scene file, lists with their lengths,
// and a hash over all bytes before it. Numbers are doubles for every precision. The file is written in
// pieces, so the caller can replace a file atomically.

#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <string_view>

#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/run/run_state.h"
#include "sim_cuda/scene/scene.h"
#include "sim_cuda/world.h"

namespace collidoscope {

/// Format version; increases with every change of content or meaning. 2: adds the ids of frozen bodies. 3:
/// adds the simulated time. 4: adds the physics version. 5: adds
/// the energies of joint loops. Versions 1 to 4 are still read.
inline constexpr std::uint32_t snapshot_version = 5, oldest_snapshot_version = 1;

struct Snapshot {
  Scene scene;
  RunState state;
  std::uint64_t state_hash = 0;                                  ///< World::state_hash() of `state`
  std::uint64_t bodies_hash = 0;                                 ///< hash_of_bodies() of `scene`
  std::int64_t physics_version = collidoscope::physics_version;  ///< of the program that made it
};

/// Hash of the constant body data: radii, masses, inertia.
std::uint64_t hash_of_bodies(const InitialBodies& bodies);

Snapshot snapshot_of(World& world);

/// Passes the bytes of the file to `write`, in order.
void write_snapshot(const Snapshot& snapshot, const std::function<void(std::string_view)>& write);

/// Reads and validates a file: kind, version, size, hash, and list lengths before memory is allocated.
/// Throws InputError with one line that begins with the file name.
Snapshot read_snapshot(const std::string& file);
/// A snapshot within an open file that can be read twice.
struct SnapshotSource {
  std::FILE* stream;
  std::uint64_t begin, bytes;  ///< where it begins in the file, and its size
  std::string name;            ///< begins the lines of errors
};
Snapshot read_snapshot(const SnapshotSource& source);

/// Continues a run. With the snapshot's own scene and physics version, it continues bit for bit. `scene` may
/// have other settings, as for World::restore(). Throws as World does. Throws InputError if the scene is the
/// same but its bodies differ (a mesh file has changed).
World world_from(const Snapshot& snapshot, const Scene& scene, const RunOptions& options);

}  // namespace collidoscope

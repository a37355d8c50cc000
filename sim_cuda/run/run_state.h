#pragma once
// State of a run: all data that, together with the scene, determine its continuation. On the host, in
// double for every precision; bit-exact. Created by World::state(), used by World::restore(), stored in
// files by snapshot.h.

#include <cstdint>
#include <vector>

#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/run/body_states.h"
#include "sim_cuda/scene/scene.h"
#include "sim_cuda/solver/warm_start.h"

namespace collidoscope {

struct RunState {
  std::int64_t steps = 0;
  BodyStates bodies;
  std::vector<StaticImpulse> static_impulses;  ///< by body; empty without walls
  WarmStart warm_start;
  /// settings_hash() of the scene. If it differs from that of the restoring world, all bodies wake.
  std::uint64_t settings = 0;
  std::vector<std::uint32_t> frozen;  ///< ids of frozen bodies, ascending
  /// Simulated time since state 0, s. NaN: unknown, from a snapshot of an older version.
  double time = 0;
};

/// Calls archive.list() or archive.lists() with each list of a state that files have had since version 1 of
/// snapshots, in file order. Not visited: `frozen` and `warm_start.loop_energies`.
template <class Archive, class State>
void visit_lists(Archive& archive, State& state) {
  // A member that is missing here is a compile error.
  auto& [steps, bodies, static_impulses, warm_start, settings, frozen, time] = state;
  auto& [position, velocity, angular_velocity, orientation] = bodies;
  auto& [contacts, walls, friction, wall_friction, rolling, wall_rolling, sleep_timer, joints,
         loop_energies] = warm_start;
  archive.list(position);
  archive.list(velocity);
  archive.list(angular_velocity);
  archive.list(orientation);
  archive.list(static_impulses);
  archive.list(contacts);
  archive.lists(walls);
  archive.list(friction);
  archive.list(wall_friction);
  archive.list(rolling);
  archive.list(wall_rolling);
  archive.list(sleep_timer);
  archive.list(joints);
}

/// A RunState whose arrays have been copied to the host, and are still to be widened.
struct CopiedRunState {
  RunState known;
  DeferredParts<BodyStates> bodies;
  WarmStartParts warm_start;

  /// The whole state. Runs on any thread, once.
  RunState complete();
};

/// Hash of all settings except the bodies; 0 if the scene has no sleeping.
std::uint64_t settings_hash(Scene scene);

/// Hash of the whole state, warm-start data included. World::state_hash() is that of the bodies alone.
std::uint64_t full_hash(const RunState& state);

/// Maps a state to other bodies. `ids`: new ids, see World::restore. Bodies not in `ids` have the state in
/// `fresh`, which contains all bodies. Contacts and joints of a removed body are removed, and their other
/// bodies get a zero sleep timer, since they may have lost support.
RunState remap_bodies(const RunState& state, const BodyIdMap& ids, BodyStates fresh);

}  // namespace collidoscope

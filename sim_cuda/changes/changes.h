#pragma once
// What is changed of a run while it runs: settings turned, bodies added and removed. One mechanism for the
// window and for runs without one, so that a list of changes, made again at the same states, leads to the
// same state bit for bit. Free functions over plain data; files of them are changes_file.h's.
//
// A change acts at a state, before the step that leads on from there. What the change leaves alone goes on:
// bodies, warm starts, sleep, joints, ledgers of the walls (World::restore). At state 0 nothing has happened
// yet, and a change of what decides the state is as if the scene had said so; frozen bodies stay frozen.
//
// Ids: a body that is added has the highest one. Where one is removed, those above it move down, so that ids
// are 0 to N-1 without holes; joints that held it are gone, and what rested on it wakes. N is the count of
// the scene's generator, without what was removed of it; its bodies lie below those that were added, which
// move up or down with it.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/run/run_state.h"
#include "sim_cuda/scene/run_options.h"
#include "sim_cuda/scene/scene.h"
#include "sim_cuda/scene/settings_patch.h"
#include "sim_cuda/world.h"

namespace collidoscope {

/// Unset members stay as they are. Made in this order: bodies frozen, settings, bodies removed, bodies added.
struct Change {
  std::int64_t step = 0;  ///< of the state at which it acts

  SettingsPatch settings;            ///< of the scene, and how it runs from then on
  std::vector<std::int64_t> remove;  ///< ids, before any of them is removed
  std::vector<Body> add;
  /// Ids, before everything else of this change: fixed where they are, as guards do. Not part of the scene.
  std::vector<std::int64_t> freeze;

  /// Whether it holds anything that decides the state.
  bool physical() const;
  /// Whether it holds a launch shape and nothing else.
  bool only_launch_shape() const;
};

/// Makes it, in a scene and options that allow it, but for bodies to freeze. Returns what became of the
/// bodies that there were; empty: their ids are what they were, where there still are so many.
BodyIdMap apply_change(const Change& change, Scene& scene, RunOptions& options);

/// Whether the bodies of `after` are others than those of `before`, so that a run with them begins at state
/// 0: another box, seed, radius, variant or spawn, or another N where each place depends on all others.
bool requires_restart(const Scene& before, const Scene& after);

/// A run at a state: what the run after a change is made of.
struct SavedRun {
  Scene scene;
  RunOptions options;
  RunState state;
};
SavedRun save_run(World& world);

/// The scene that the run after a change begins with at state 0, if it does. Throws InputError.
std::optional<Scene> scene_after_restart(const World& world, const Change& change);

/// The run after a change: another World, or null where `world` itself could change, its launch shape.
/// `options` are world's own, or such with another executor. `rest`: where it begins at state 0, the state to
/// begin in, of a scene that settles (presimulation.h); else it is made here. Throws as World does, and
/// changes nothing then.
std::unique_ptr<World> world_after_change(World& world, const Change& change, RunOptions options,
                                          const RunState* rest = nullptr);
/// The same from a state that was kept; never null.
std::unique_ptr<World> world_after_change(const SavedRun& run, const Change& change, RunOptions options,
                                          const RunState* rest = nullptr);

/// Adds a change to those that a run has been through. A change of how it runs takes the place of one of the
/// same state, or, with `extends_last`, of the one that it goes on from (a slider that is still held).
void record_change(std::vector<Change>& changes, Change change, bool extends_last = false);
/// The run begins again with all that was changed, but for bodies that were frozen: they move again.
void record_restart(std::vector<Change>& changes);
/// One change of state 0 that makes `after` of `before`, a scene with the same changes made one by one:
/// `settings`, and bodies to remove and to add. None where no single change does.
std::optional<Change> merged_change(const Scene& before, const Scene& after, Change settings);

/// Bodies that the scene makes.
std::int64_t bodies_of(const Scene& scene);

}  // namespace collidoscope

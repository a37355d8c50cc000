#pragma once
// Changes of a run in progress: settings, added and removed bodies. The window and batch runs use the same
// functions. So a list of changes, applied at the same states, leads to the same state bit for bit. Free
// functions over plain data; changes_file.h reads and writes files of them.
//
// A change acts at a state, before its next step. Everything else continues: bodies, warm-start data,
// sleep, joints, static impulses (World::restore). At state 0, a physical change is equivalent to a changed
// scene file; frozen bodies stay frozen.
//
// Ids: an added body gets the highest id. When a body is removed, higher ids move down, so ids are always 0
// to N-1. Joints of a removed body are removed, and bodies that touched it wake. N counts the bodies of the
// scene's generator, without removed ones. Added bodies have higher ids than generated ones, and move with
// N.

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

/// A change. Unset members keep their values. Order: bodies frozen, settings, bodies removed, bodies added.
struct Change {
  std::int64_t step = 0;  ///< number of the state at which it acts

  SettingsPatch settings;            ///< settings of the scene and of the execution
  std::vector<std::int64_t> remove;  ///< ids before any of them is removed
  std::vector<Body> add;
  /// Ids before the other parts of this change. The bodies become static where they are, as by guards. Not
  /// part of the scene.
  std::vector<std::int64_t> freeze;

  /// True if it changes anything that determines the state.
  bool physical() const;
  /// True if it contains only a launch shape.
  bool only_launch_shape() const;
};

/// Applies a change to a scene and options, except for `freeze`. Precondition: the change is valid for
/// them. Returns the new ids of the existing bodies; empty: ids are unchanged, except for bodies that no
/// longer exist.
BodyIdMap apply_change(const Change& change, Scene& scene, RunOptions& options);

/// True if the bodies of `after` differ from those of `before`, so that a run must restart at state 0. That
/// is: another box, seed, radius, variant or spawn; or another N if positions depend on N.
bool requires_restart(const Scene& before, const Scene& after);

/// Saved run: input of world_after_change().
struct SavedRun {
  Scene scene;
  RunOptions options;
  RunState state;
};
SavedRun save_run(World& world);

/// The scene with which the run restarts at state 0 after a change; empty if it does not restart. Throws
/// InputError.
std::optional<Scene> scene_after_restart(const World& world, const Change& change);

/// Creates the World after a change. Returns null if `world` itself was changed (launch shape only).
/// `options`: those of `world`, with another executor allowed. `rest`: for a restart of a `settled` scene,
/// its state at rest (presimulation.h); null: computed here. Throws as World does; nothing changes then.
std::unique_ptr<World> world_after_change(World& world, const Change& change, RunOptions options,
                                          const RunState* rest = nullptr);
/// The same from a saved run; never returns null.
std::unique_ptr<World> world_after_change(const SavedRun& run, const Change& change, RunOptions options,
                                          const RunState* rest = nullptr);

/// Appends a change to the recorded changes of a run. A change of the execution only replaces the last one
/// if that is of the same state. With `extends_last`, it replaces the last one of any state (a slider being
/// dragged).
void record_change(std::vector<Change>& changes, Change change, bool extends_last = false);
/// Moves all recorded changes to state 0 for a restart. Frozen bodies are released.
void record_restart(std::vector<Change>& changes);
/// One change of state 0 that turns `before` into `after`: `settings`, and bodies to remove and to add.
/// Empty if no single change does. Precondition: `after` results from changes of `before`.
std::optional<Change> merged_change(const Scene& before, const Scene& after, Change settings);

}  // namespace collidoscope

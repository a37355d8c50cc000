#pragma once
// A World whose settings can be changed while it runs, with the history of its last steps. Owns both. Lives
// as long as the program; the World inside is made anew where a setting asks for it.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/changes/changes_file.h"
#include "sim_cuda/run/history.h"
#include "sim_cuda/world.h"
#include "ui/workspace.h"

namespace collidoscope {

/// What is in effect in a World.
Settings settings_of(const World& world);

class LiveWorld {
 public:
  /// Throws as World does.
  LiveWorld(const Scene& scene, const RunOptions& options);
  explicit LiveWorld(World world);

  World& world() { return *world_; }
  const World& world() const { return *world_; }
  const History& history() const { return history_; }
  /// Settings in effect.
  Settings settings() const { return settings_of(*world_); }
  /// N, radius, seed and variant can be changed.
  bool generated() const { return world_->scene().generators.size() == 1; }
  /// Whether what decides the state was changed since state 0.
  bool edited() const { return edited_; }
  /// What was changed since this world was made, for a replay of it from where it began. Settings that are
  /// changed several times at one state are one change, of their last values. At state 0 all is one change.
  const std::vector<Change>& changes() const { return changes_; }
  /// The same as a file, with the state that it led to.
  std::string changes_text();
  /// Changes whenever world() is another one: whoever keeps what belongs to it asks this.
  int generation() const { return generation_; }

  /// Brings settings() to `request`. (B, T) change in place; what the result does not depend on, time step,
  /// restitution, precision and N go to a new World that takes over its state; what changes the box, the
  /// radii or the seed starts again. Returns what should be said of it, mostly nothing. Throws InputError or
  /// MachineError, and changes nothing then.
  /// `rest`: the state that a scene which settles begins in, where scene_after_restart() says so.
  /// `extends_last`: with the slider that the last change came from, which is still held.
  std::string apply(const Settings& request, const RunState* rest = nullptr, bool extends_last = false);
  /// The scene that the same would begin anew with, if it does; valid. Throws InputError.
  std::optional<Scene> scene_after_restart(const Settings& request) const;
  /// The same of any change; its step is the current one.
  std::string apply(Change change);
  /// What became of the bodies at the last change; empty: their ids are what they were.
  const BodyIdMap& last_id_map() const { return last_id_map_; }
  /// Another run in place of this one, at whatever state it is in, without history and with nothing changed.
  /// `script`: what it changes of itself on its way; it begins again with its first scene, not with the
  /// settings in effect.
  struct Script {
    Scene scene;
    RunOptions options;
    std::vector<Change> changes;  ///< steps ascending
  };
  void open(World world, Script script = {});
  /// What was changed of this run since it was made, apart from the World.
  struct Record {
    std::vector<Change> changes;
    Scene first_scene;
    Settings first_settings;
    std::int64_t began;
    bool edited;
  };
  Record record() const { return {changes_, first_scene_, first_settings_, began_, edited_}; }
  /// A run that was left, at the state that it was in; its changes go on.
  void open(World world, Record record);
  bool scripted() const { return !script_.changes.empty(); }
  /// Back to state 0, with the settings in effect.
  void restart(const RunState* rest = nullptr);

  /// Fixes a body where it is, as guards do; a change like others.
  void freeze(std::uint32_t body);

  /// One step, added to the history; measured, too, if `measured`. False where guards found something, and
  /// the world stands at the state that it was in.
  bool step(bool measured);
  /// Of the current state, measured at most once for each.
  const StepStats& stats();
  std::uint64_t state_hash();
  /// Boxes of each level of the tree, from the root: of the current state, or, unless `exact`, of one that
  /// was asked for before, since arranging a tree takes time.
  const std::vector<std::int64_t>& level_sizes(bool exact);
  /// s of the clock that the last change of the World took.
  double last_change_seconds() const { return change_seconds_; }

 private:
  /// The run before the last of `changes_`, which changed settings and nothing else. As long as no step was
  /// made, what changes more of them is made of that run: as if the last values were the only ones.
  struct Pending {
    SavedRun run;
    Settings settings;
    bool edited;
  };
  void made(const Change& change, const Scene& before, std::unique_ptr<World> next);
  void collapse();
  void record_frozen(const std::vector<std::uint32_t>& known, std::int64_t step);
  void begin_record();
  void replace(std::unique_ptr<World> world);
  void play_script();
  void set_guards(std::optional<OnFailure> request);

  std::unique_ptr<World> world_;
  History history_;
  std::vector<Change> changes_;
  std::optional<Pending> pending_;
  Scene first_scene_;  ///< that changes_ begin with, and its settings
  Settings first_settings_;
  Script script_;
  std::size_t next_in_script_ = 0;
  ValidationSettings guards_;  ///< limits of the scene that had some
  BodyIdMap last_id_map_;
  std::int64_t began_ = 0;  ///< the state that it was given, of a snapshot
  bool edited_ = false, stats_known_ = false, hash_known_ = false;
  StepStats stats_;
  std::uint64_t hash_ = 0;
  std::vector<std::int64_t> level_sizes_;
  std::int64_t level_sizes_step_ = -1;  ///< of the state that they are of; -1: none
  int generation_ = 0;
  double change_seconds_ = 0;
};

/// Adds the step that the World just made. `measured`: its stats at the state that it led to, or null.
void record_step(World& world, const StepStats* measured, History& history);

/// What leads from `now` to `request`, but for the executor, which no run is told.
Change change_between(const Settings& now, const Settings& request);

}  // namespace collidoscope

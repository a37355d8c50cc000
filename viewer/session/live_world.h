#pragma once
// A World whose settings can change while it runs, with the history of its last steps. Owns both. Some
// settings replace the World.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/changes/changes_file.h"
#include "sim_cuda/recording/recorded_run.h"
#include "sim_cuda/run/history.h"
#include "sim_cuda/run/run_lanes.h"
#include "sim_cuda/world.h"
#include "ui/workspace.h"

namespace collidoscope {

/// The present settings of a World.
Settings settings_of(const World& world);
/// Those of a scene. `bodies`: their number, if the scene has not one generator.
Settings settings_of(const Scene& scene, const RunOptions& options, std::int64_t bodies);

class LiveWorld {
 public:
  /// Throws as World does.
  LiveWorld(const Scene& scene, const RunOptions& options);
  explicit LiveWorld(World world);

  World& world() { return *world_; }
  const World& world() const { return *world_; }
  const History& history() const { return history_; }
  /// The present settings.
  Settings settings() const { return settings_of(*world_); }
  /// Whether the scene has one generator, whose settings can change.
  bool generated() const { return world_->scene().generators.size() == 1; }
  /// Whether a setting that affects the state was changed since state 0.
  bool edited() const { return edited_; }
  /// Changes since this world was made, for a replay from its initial state. Several changes of settings at
  /// one state are combined into one with the last values. All changes at state 0 are one change.
  const std::vector<Change>& changes() const { return changes_; }
  /// The changes as a file, with the hash of the present state.
  std::string changes_text();
  /// Increases when world() is replaced; use it to invalidate data about the World.
  int generation() const { return generation_; }

  /// Applies the requested settings. (B, T) change in place. Settings that keep the bodies use a new World,
  /// which continues from the present state. Box, radii and seed restart the run. Returns a notice, usually
  /// empty. Throws InputError or MachineError without a change.
  /// `rest`: settled initial state, if scene_after_restart() needs pre-simulation.
  /// `extends_last`: the change comes from the same held slider as the last one.
  std::string apply(const Settings& request, const RunState* rest = nullptr, bool extends_last = false);
  /// The validated scene after a restart, if apply() would restart the run. Throws InputError.
  std::optional<Scene> scene_after_restart(const Settings& request) const;
  /// Applies a change at the present step.
  std::string apply(Change change);
  /// New ids of the bodies after the last change; empty: unchanged.
  const BodyIdMap& last_id_map() const { return last_id_map_; }
  /// Replaces the run by another one at any state, without history and recorded changes. `script`: changes
  /// that the new run applies by itself. A restart uses the script's scene, not the present settings.
  struct Script {
    Scene scene;
    RunOptions options;
    std::vector<Change> changes;  ///< ordered by step
  };
  void open(World world, Script script = {});
  /// Record of the changes, separate from the World.
  struct Record {
    std::vector<Change> changes;
    Scene first_scene;
    Settings first_settings;
    std::int64_t began;
    bool edited;
  };
  Record record() const { return {changes_, first_scene_, first_settings_, began_, edited_}; }
  /// Restores a run and its record of changes.
  void open(World world, Record record);
  /// Takes over the states and changes of a recorded run. Precondition: the world is at one of its states.
  void take_recording(RecordedRun run);
  bool scripted() const { return !script_.changes.empty(); }
  /// Restarts at state 0 with the present settings.
  void restart(const RunState* rest = nullptr);

  /// All states of this run. The world is at one of them.
  const Timeline& timeline() const { return timeline_; }
  const RunLanes& lanes() const { return lanes_; }
  /// Changes, and what was found at states of this run, ascending.
  std::vector<TimelineMark> marks() const;
  /// Adds a mark at the present state, unless it is known.
  void mark(TimelineMark::Kind kind, const std::string& text);
  /// The run before the last branch.
  std::optional<WorkspaceView::TimelineView::Other> other_run() const;
  /// Exchanges this run and the run before the last branch. The world goes to the same state number, or to
  /// the nearest one that the run has. Precondition: other_run(). Throws as go_to() does.
  void open_other_run();
  /// Goes to a state of this run. Further steps go through the known states again, as long as nothing is
  /// changed. A change in an earlier state starts a branch: the run until then is kept as other_run().
  /// Throws MachineError if the state has another hash than before; nothing changes then. Precondition: the
  /// timeline has the state.
  void go_to(std::int64_t step);

  /// Freezes a body as guards do. Recorded as a change.
  void freeze(std::uint32_t body);

  /// Makes one step and adds it to the history, with measurements if `measured`. Returns false if guards
  /// found a violation; the state is unchanged then.
  bool step(bool measured);
  /// Measurements of the present state, cached.
  const StepStats& stats();
  /// Wall-clock time of the last measurement, s.
  double measure_seconds() const { return measure_seconds_; }
  std::uint64_t state_hash();
  /// Boxes per level of the tree, from the root. Unless `exact`, the result may be that of an earlier state,
  /// since ordering a tree takes time.
  const std::vector<std::int64_t>& level_sizes(bool exact);
  /// Wall-clock time of the last change of the World, s.
  double last_change_seconds() const { return change_seconds_; }

 private:
  /// The run before the last entry of `changes_`, which changed only settings. Until the next step, further
  /// changes of settings are applied to this run, as if only the last values had been set.
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
  void branch(std::int64_t now);
  void adopt(std::unique_ptr<World> world);
  void forget_other_run();
  bool pass_known_state(bool measured);
  void note_step(bool measured);

  std::unique_ptr<World> world_;
  History history_;
  Timeline timeline_;
  RunLanes lanes_;
  std::vector<TimelineMark> found_;  ///< marks except those of changes
  std::vector<Change> changes_;
  struct OtherRun {
    Timeline timeline;
    RunLanes lanes;
    std::vector<TimelineMark> found;
    std::vector<Change> changes;
    History history;
    bool edited;
    std::int64_t fork;  ///< last common state
  };
  std::unique_ptr<OtherRun> other_;
  std::optional<Pending> pending_;
  Scene first_scene_;  ///< initial scene of changes_
  Settings first_settings_;
  Script script_;
  std::size_t next_in_script_ = 0;
  ValidationSettings guards_;  ///< limits of the last scene with guards
  BodyIdMap last_id_map_;
  std::int64_t began_ = 0;  ///< initial state; greater than 0 for a snapshot
  bool edited_ = false, stats_known_ = false, hash_known_ = false;
  StepStats stats_;
  std::uint64_t hash_ = 0;
  std::vector<std::int64_t> level_sizes_;
  std::int64_t level_sizes_step_ = -1;  ///< state of level_sizes_; -1: none
  int generation_ = 0;
  double change_seconds_ = 0, measure_seconds_ = 0;
};

/// Adds the last step of the World to the history. `measured`: measurements of the state after it, or null.
void record_step(World& world, const StepStats* measured, History& history);

/// The change that leads from `now` to `request`, without the executor.
Change change_between(const Settings& now, const Settings& request);

}  // namespace collidoscope

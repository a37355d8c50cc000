#include "sim_cuda/recording/recorded_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <span>
#include <utility>

#include "sim_cuda/changes/changes_file.h"
#include "sim_cuda/core/atomic_file.h"
#include "sim_cuda/core/cancellation.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/recording/recording_chunks.h"
#include "sim_cuda/scene/initial_bodies.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {
namespace {

using RunEvent = RecordingReader::Event;

/// Whether a change is part of a state of the same number. Bodies that guards froze in the step after the
/// state are not.
bool is_in(const RunState& state, const Change& change) {
  const bool only_freezes = change.settings.empty() && change.remove.empty() && change.add.empty();
  return !only_freezes || std::ranges::all_of(change.freeze, [&](std::int64_t body) {
    return std::ranges::binary_search(state.frozen, static_cast<std::uint32_t>(body));
  });
}

/// Writes the states of a timeline in their order.
class RunWriter {
 public:
  RunWriter(RecordingWriter& writer, const Timeline& timeline) : writer_(writer), timeline_(timeline) {
    scene_ = *timeline.keyframes().front().kept->scene;
  }
  void write_hashes_up_to(std::int64_t state) {
    if (state == written_ + timeline_.first()) return;
    const std::span<const StateHashes> all(timeline_.hashes());
    const std::int64_t end = state - timeline_.first();
    write_hashes_chunk(
        writer_, written_ + timeline_.first(),
        all.subspan(static_cast<std::size_t>(written_), static_cast<std::size_t>(end - written_)));
    written_ = state - timeline_.first();
  }
  void write(const Change& change) {
    write_hashes_up_to(change.step);
    write_change_chunk(writer_, change, scene_);
    RunOptions unused;
    apply_change(change, scene_, unused);
  }
  void write(const Timeline::Kept& kept, RunState state) {
    write_hashes_up_to(state.steps);
    if (kept.scene != hashed_scene_) bodies_hash_ = hash_of_bodies(initial_bodies(*kept.scene));
    hashed_scene_ = kept.scene;
    Snapshot snapshot{*kept.scene, std::move(state), kept.hash, bodies_hash_};
    disable_guards(snapshot.scene.physics);
    write_keyframe_chunk(writer_, snapshot);
  }

 private:
  RecordingWriter& writer_;
  const Timeline& timeline_;
  Scene scene_;               ///< after the last written change
  std::int64_t written_ = 0;  ///< number of written hashes
  std::shared_ptr<const Scene> hashed_scene_;
  std::uint64_t bodies_hash_ = 0;  ///< of hashed_scene_
};

/// Reads the events of a recording in their order.
class RunReader {
 public:
  explicit RunReader(const RecordingReader& recording) : recording_(recording) {}
  RecordedRun read() {
    for (const RunEvent& event : recording_.events()) switch (event.kind) {
        case RecordingReader::Kind::keyframe:
          read_keyframe(event);
          break;
        case RecordingReader::Kind::change:
          read_change(event);
          break;
        case RecordingReader::Kind::hashes:
          require_last_state(event);
          for (const StateHashes& hashes : event.hashes)
            run_.timeline.add_hashes({hashes.bodies, event.version == hashes_version ? hashes.full : 0});
          break;
      }
    return std::move(run_);
  }

 private:
  void require_last_state(const RunEvent& event) const {
    if (event.step != run_.timeline.last())
      throw InputError(fmt::format("{}: state {}, expected state {}", recording_.place(event), event.step,
                                   run_.timeline.last()));
  }
  void read_keyframe(const RunEvent& event) {
    Snapshot snapshot = recording_.keyframe(event);
    std::string text = write_scene(snapshot.scene);
    if (!scene_ || text != scene_text_) scene_ = std::make_shared<const Scene>(snapshot.scene);
    scene_text_ = std::move(text);
    now_ = std::move(snapshot.scene);
    Timeline::Kept kept{scene_, CompactState(snapshot.state), snapshot.state_hash};
    if (&event == recording_.events().data()) return run_.timeline.begin(std::move(kept));
    require_last_state(event);
    run_.timeline.add(
        {std::make_shared<const Timeline::Kept>(std::move(kept)), std::exchange(changed_, false)});
  }
  void read_change(const RunEvent& event) {
    require_last_state(event);
    RunOptions unused;
    const ChangeList list =
        parse_changes(recording_.change(event), recording_.place(event), now_, unused, event.step);
    if (list.changes.size() != 1 || list.changes[0].step != event.step)
      throw InputError(recording_.place(event) + ": expected one change of the state of the chunk");
    apply_change(list.changes[0], now_, unused);
    run_.changes.push_back(list.changes[0]);
    changed_ = true;
  }

  const RecordingReader& recording_;
  RecordedRun run_;
  std::shared_ptr<const Scene> scene_;  ///< of the last keyframe
  std::string scene_text_;
  Scene now_;             ///< after the last change
  bool changed_ = false;  ///< since the last keyframe
};

}  // namespace

RecordedRun read_run(const RecordingReader& recording) { return RunReader(recording).read(); }

void write_run(const std::string& file, const Timeline& timeline, const std::vector<Change>& changes,
               World& world) {
  AtomicFile target(file);
  RecordingWriter writer(target);
  write_meta_chunk(writer, world);
  RunWriter run(writer, timeline);
  auto change = std::ranges::upper_bound(changes, timeline.first(), {}, &Change::step);
  for (const Timeline::Keyframe& keyframe : timeline.keyframes()) {
    if (const Cancellation* asked = world.options().cancellation; asked && asked->requested())
      throw Cancelled();
    RunState state = keyframe.kept->state.state();
    for (; change != changes.end() && change->step <= state.steps; ++change) {
      if (change->step == state.steps && !is_in(state, *change)) break;
      if (change->physical()) run.write(*change);
    }
    run.write(*keyframe.kept, std::move(state));
  }
  for (; change != changes.end(); ++change)
    if (change->physical()) run.write(*change);
  run.write_hashes_up_to(timeline.last());
  if (world.steps() == timeline.last() && timeline.keyframes().back().state() != timeline.last())
    write_keyframe_chunk(writer, snapshot_of(world));
  writer.write(chunk_types::end, "");
  target.commit();
}

}  // namespace collidoscope

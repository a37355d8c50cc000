#include "sim_cuda/recording/replay.h"

#include <fmt/format.h>

#include <utility>

#include "sim_cuda/changes/changes_file.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/run/run_state.h"

namespace collidoscope {
namespace {

using RecordedEvent = RecordingReader::Event;

/// Removes the settings of the execution, which do not affect the state.
Change physical_part(Change change) {
  SettingsPatch physical;
  change.settings.for_each_set([&]<auto member>(const Field<member>& setting, const auto& value) {
    if (is_physical(setting)) physical.set<member>(value);
  });
  change.settings = physical;
  return change;
}

class Replayed {
 public:
  Replayed(const RecordingReader& recording, const RunOptions& options)
      : recording_(recording), options_(options), world_(first_world()) {}

  ReplayResult run(const std::function<void(std::int64_t)>& done) {
    for (const RecordedEvent& event : recording_.events()) {
      switch (event.kind) {
        case RecordingReader::Kind::keyframe:
          compare_keyframe(event);
          break;
        case RecordingReader::Kind::change:
          repeat_change(event);
          break;
        case RecordingReader::Kind::hashes:
          step_through(event, done);
          break;
      }
      if (result_.difference) break;
    }
    return result_;
  }

 private:
  World first_world() const {
    const RecordedEvent& first = recording_.events().front();
    const Snapshot snapshot = recording_.keyframe(first);
    if (snapshot.physics_version != physics_version)
      throw MachineError(
          fmt::format("{}: cannot verify: recorded with physics version {}, this program has version {}",
                      recording_.name(), snapshot.physics_version, physics_version));
    return world_from(snapshot, snapshot.scene, options_);
  }
  void require_step(const RecordedEvent& event) {
    if (event.step != world_.steps())
      throw InputError(fmt::format("{}: state {}, expected state {}", recording_.place(event), event.step,
                                   world_.steps()));
  }
  void compare(const RecordedEvent& event, std::uint64_t recorded, std::uint64_t actual, const char* what) {
    if (recorded == actual || result_.difference) return;
    result_.difference = fmt::format("{}: state {}: recorded {} {:016x}, actual {:016x}",
                                     recording_.place(event), world_.steps(), what, recorded, actual);
  }
  void compare_keyframe(const RecordedEvent& event) {
    require_step(event);
    compare(event, event.full_hash, full_hash(world_.state()), "hash with warm-start data");
    if (!result_.difference) ++result_.keyframes;
  }
  void repeat_change(const RecordedEvent& event) {
    require_step(event);
    const ChangeList list = parse_changes(recording_.change(event), recording_.place(event), world_.scene(),
                                          world_.options(), world_.steps());
    if (list.changes.size() != 1 || list.changes[0].step != world_.steps())
      throw InputError(recording_.place(event) + ": expected one change of the state of the chunk");
    const Change change = physical_part(list.changes[0]);
    if (change.physical())
      if (auto next = world_after_change(world_, change, world_.options())) world_ = std::move(*next);
    ++result_.changes;
  }
  void step_through(const RecordedEvent& event, const std::function<void(std::int64_t)>& done) {
    require_step(event);
    for (const StateHashes& recorded : event.hashes) {
      const std::int64_t before = world_.steps();
      world_.step(1);
      if (world_.steps() == before) {
        result_.difference = fmt::format("{}: state {}: guards pause the run, which the recording continues",
                                         recording_.place(event), before);
        return;
      }
      world_.records().record_hashes(true);
      StateHashes actual = world_.hashes();
      if (event.version == 1 && recorded.full != 0) actual.full = full_hash(world_.state());
      compare(event, recorded.bodies, actual.bodies, "hash");
      if (recorded.full != 0) compare(event, recorded.full, actual.full, "hash with warm-start data");
      if (result_.difference) return;
      done(++result_.states);
    }
  }

  const RecordingReader& recording_;
  const RunOptions options_;
  World world_;
  ReplayResult result_;
};

}  // namespace

ReplayResult replay(const RecordingReader& recording, const RunOptions& options,
                    const std::function<void(std::int64_t)>& done) {
  return Replayed(recording, options).run(done);
}

}  // namespace collidoscope

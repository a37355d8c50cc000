#pragma once
// All states of a run, in memory: keyframes, and a hash of every state. A state between keyframes is
// simulated again, with the same bits. Owned by the class that steps the run.

#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/recording/compact_state.h"
#include "sim_cuda/world.h"

namespace collidoscope {

class Timeline {
 public:
  /// A state from which others are simulated. Shared by copies of the timeline.
  struct Kept {
    std::shared_ptr<const Scene> scene;
    CompactState state;
    std::uint64_t hash;  ///< World::state_hash()
  };
  struct Keyframe {
    std::shared_ptr<const Kept> kept;
    bool is_change;  ///< or the first one
    std::int64_t state() const { return kept->state.steps(); }
    std::int64_t bytes() const { return kept->state.bytes(); }
  };

  /// `budget`: bytes of keyframes. At least one keyframe is kept. If those of changes exceed the budget, the
  /// oldest states are forgotten, so first() increases.
  explicit Timeline(std::int64_t budget = default_budget());
  void set_budget(std::int64_t budget);
  /// 1 GiB, or a quarter of the available memory if that is less.
  static std::int64_t default_budget();

  /// Begins at the present state of the world. Forgets everything before.
  void begin(World& world);
  void begin(Kept first);
  /// Call after each step from the last state. `seconds`: that it took. Further steps of the world compute
  /// the hashes. A keyframe of a world on a GPU is packed by another thread.
  void record_step(World& world, double seconds);
  /// Call after a change was made at the last state, and after a step in which guards froze bodies.
  void record_change(World& world);
  /// Adds a keyframe of the last state, instead of one there.
  void add(Keyframe keyframe);
  /// Adds the hashes of the next state.
  void add_hashes(const StateHashes& hashes) { hashes_.push_back(hashes); }
  /// Forgets the states after `step`. Precondition: first() <= step <= last().
  void forget_after(std::int64_t step);

  std::int64_t first() const { return keyframes_.front().state(); }
  std::int64_t last() const { return first() + std::ssize(hashes_); }
  bool is_change(std::int64_t step) const;

  /// A world at a state, after its change if it has one, without guards. `options`: where it is simulated.
  /// Precondition: first() <= step <= last(). Throws MachineError if the state has another hash than before.
  ///
  /// If states are reached in descending order, those before the requested one are kept for the next
  /// requests, within a tenth of the budget.
  std::unique_ptr<World> world_at(std::int64_t step, const RunOptions& options);
  /// Compares the world, after a step, with the recorded hashes of its state. Throws MachineError if they
  /// differ.
  void check(World& world) const;
  bool agrees(World& world) const;

  /// Without a keyframe that is still being packed, like keyframes().
  std::int64_t bytes() const { return bytes_; }
  /// Ascending; at least one after begin().
  const std::vector<Keyframe>& keyframes() const { return keyframes_; }
  /// World::hashes() of the states first() + 1 to last(), before changes there.
  const std::vector<StateHashes>& hashes() const { return hashes_; }

  /// Keyframes are so far apart that simulating up to the next one takes about this time, s, or longer if
  /// keyframes would take more than a twentieth of the time, or more memory than the budget.
  static constexpr double keyframe_seconds = 0.25;

 private:
  Keyframe keyframe_of(World& world, bool is_change);
  void begin_keyframe(World& world);
  void end_keyframe();
  std::optional<std::string> difference(World& world) const;
  void fit_budget();
  void thin_out();
  void forget_oldest();
  std::vector<Keyframe>::const_iterator keyframe_at_or_before(std::int64_t step) const;

  std::int64_t budget_, bytes_ = 0;
  std::vector<std::shared_ptr<const Kept>> trail_;  ///< states before the last one that was reached
  std::int64_t reached_ = -1;                       ///< by world_at()
  std::vector<Keyframe> keyframes_;                 ///< ascending; at least one after begin()
  std::vector<StateHashes> hashes_;                 ///< see hashes()
  double seconds_ = 0;                              ///< of the steps since the last keyframe
  double interval_ = keyframe_seconds;
  double cost_ = 0;                       ///< of the last keyframe, on the thread of the run, s
  std::shared_future<Keyframe> packing_;  ///< a keyframe that another thread packs, after the others
};

}  // namespace collidoscope

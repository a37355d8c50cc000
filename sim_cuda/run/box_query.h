#pragma once
// Runs one broad phase on given boxes: no bodies, no dynamics. Owns an executor with the boxes, the method
// and its list of pairs.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/bvh_cache.h"
#include "sim_cuda/broad_phase/pair_list.h"
#include "sim_cuda/core/stage_times.h"
#include "sim_cuda/scene/run_options.h"

namespace collidoscope {

/// All pairs, ordered: the partners of box a are second[k] for k in offset[a] .. offset[a + 1] - 1, ascending
/// and above a.
struct BoxPairs {
  std::vector<std::uint32_t> offset, second;
  friend bool operator==(const BoxPairs&, const BoxPairs&) = default;
};

/// Pairs of one list that the other lacks, up to a number of examples.
struct PairDifference {
  std::int64_t missing = 0, excess = 0;  ///< pairs of `expected` only, and of `actual` only
  std::vector<std::pair<std::uint32_t, std::uint32_t>> missing_examples, excess_examples;
};
PairDifference compare_pairs(const BoxPairs& expected, const BoxPairs& actual, std::size_t examples = 3);

class BoxQuery {
 public:
  /// `boxes`: each finite with min <= max; at least one. Throws InputError or MachineError as World does.
  BoxQuery(RunOptions options, const std::vector<Aabb>& boxes);

  /// Replaces the boxes by the same number of others.
  void move(const std::vector<Aabb>& boxes);
  /// Finds the pairs. Enlarges the list if needed.
  BoxPairs find();
  bool has_tree() const { return method_->tree_nodes() > 0; }
  /// Precondition: find() was called, and there is a tree.
  const TreeQuality& quality() { return cache_.quality(*method_, method_bytes_); }
  /// From boxes to the ordered list of pairs. Precondition: find() was called.
  BroadPhaseTimes time(int repeats);

  /// See BroadPhase::pair_check().
  std::optional<PairCheck> pair_check() const { return method_->pair_check(); }

  const std::string& device_name() const { return executor_.device_name(); }
  double equal_cores() const { return executor_.equal_cores(); }
  int key_bits() const { return executor_.options().key_bits; }
  std::int64_t method_bytes() const { return method_bytes_; }

 private:
  void enqueue();

  std::int64_t count_;
  Executor executor_;
  Buffer<Aabb> boxes_, extent_;
  Buffer<StepControl> control_;
  PairList pairs_;
  std::unique_ptr<BroadPhase> method_;
  std::int64_t method_bytes_ = 0;
  BvhCache cache_;
};

}  // namespace collidoscope

#pragma once
// Interface of all broad phases: from boxes to overlapping pairs. Each method has one file, and one line in
// broad_phase.cpp. All methods find the same pairs, which pair_list.h orders, so the state does not depend on
// the method.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/broad_phase/pair_check.h"
#include "sim_cuda/broad_phase/tree.h"
#include "sim_cuda/core/aabb.h"
#include "sim_cuda/core/executor.h"
#include "sim_cuda/core/pair.h"

namespace collidoscope {

struct PairSink;
struct VisitSink;
struct BroadPhaseMethod;

class BroadPhase {
 public:
  virtual ~BroadPhase() = default;

  /// Allocates memory for `bodies` bodies. Call outside the step, before the first update and when N changes.
  virtual void reserve(std::int64_t bodies) = 0;
  /// Allocates memory for the capacity of the sinks of find_pairs(), in pairs. Call outside the step.
  virtual void reserve_pairs(std::int64_t) {}
  /// Builds the acceleration structure over this step's boxes (one per body, by id). The boxes must stay
  /// valid until the next update. Each is finite with min <= max, or Aabb::empty(). `extent`, in the
  /// executor's memory, contains most centres.
  virtual void update(const Aabb* boxes, const Aabb* extent) = 0;
  /// Passes every pair of bodies with overlapping boxes to the sink, once, in any order.
  virtual void find_pairs(const PairSink& sink) = 0;
  /// Counts the node visits of find_pairs(), with the same traversal. No effect if the method has no
  /// hierarchy.
  virtual void count_visits(const VisitSink&) const {}
  /// Number of leaves and inner nodes; 0 without a hierarchy or without bodies.
  virtual std::int64_t tree_nodes() const { return 0; }
  /// Writes the hierarchy of the last update (tree.h). Call outside the step.
  virtual void write_tree(const TreeSink&) const {}
  /// What was found about the pairs of a plug-in so far; unset for built-in methods. Waits for the device.
  virtual std::optional<PairCheck> pair_check() const { return std::nullopt; }
};

/// Throws InputError for an unknown name; the message lists the valid names. Throws MachineError if the
/// method does not run on this executor.
std::unique_ptr<BroadPhase> make_broad_phase(const std::string& name, Executor& executor);

// Factories, each defined in the file of its method.
std::unique_ptr<BroadPhase> make_brute_force(Executor& executor);
std::unique_ptr<BroadPhase> make_brute_force_tiled(Executor& executor);
std::unique_ptr<BroadPhase> make_bsp(Executor& executor);
std::unique_ptr<BroadPhase> make_bullet_dbvt(Executor& executor);
std::unique_ptr<BroadPhase> make_bvh_bottom_up(Executor& executor);
std::unique_ptr<BroadPhase> make_bvh_input_order(Executor& executor);
std::unique_ptr<BroadPhase> make_bvh_recursive(Executor& executor);
std::unique_ptr<BroadPhase> make_hierarchical_grid(Executor& executor);
std::unique_ptr<BroadPhase> make_kd_tree(Executor& executor);
std::unique_ptr<BroadPhase> make_lbvh_ropes(Executor& executor);
std::unique_ptr<BroadPhase> make_ploc(Executor& executor);
std::unique_ptr<BroadPhase> make_plugin(Executor& executor, const BroadPhaseMethod& method);
std::unique_ptr<BroadPhase> make_refit(Executor& executor);
std::unique_ptr<BroadPhase> make_uniform_grid(Executor& executor);
std::unique_ptr<BroadPhase> make_lbvh_top_down(Executor& executor);

}  // namespace collidoscope

#pragma once
// The interface of all broad phases: from boxes to the ordered list of pairs. A method is one file and one
// line in broad_phase.cpp. All find the same pairs in the same order, so the state does not depend on the
// choice.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sim_cuda/broad_phase/tree.h"
#include "sim_cuda/core/aabb.h"
#include "sim_cuda/core/executor.h"
#include "sim_cuda/core/pair.h"

namespace collidoscope {

struct PairSink;
struct VisitSink;

class BroadPhase {
 public:
  virtual ~BroadPhase() = default;

  /// Prepares for that many bodies; called outside the step, before the first update and when N changes.
  virtual void reserve(std::int64_t bodies) = 0;
  /// Takes this step's boxes (one per body, by id; they stay until the next update), each of which is finite
  /// with min <= max, or Aabb::empty(). `extent`, in the executor's memory, holds most centres.
  virtual void update(const Aabb* boxes, const Aabb* extent) = 0;
  /// Gives every pair of bodies whose boxes overlap to the sink, each once, in any order.
  virtual void find_pairs(const PairSink& sink) = 0;
  /// Counts what find_pairs() reads of the hierarchy of the last update, by the same traversal. Nothing where
  /// the method has no hierarchy.
  virtual void count_visits(const VisitSink&) const {}
  /// Leaves and inner nodes of its hierarchy; 0 where the method has none, or there are no bodies.
  virtual std::int64_t tree_nodes() const { return 0; }
  /// Writes the hierarchy over the boxes of the last update; called outside the step (tree.h).
  virtual void write_tree(const TreeSink&) const {}
};

/// Throws InputError for an unknown name; the line lists the known ones. Throws MachineError for what cannot
/// run on this executor.
std::unique_ptr<BroadPhase> make_broad_phase(const std::string& name, Executor& executor);

// One factory per method, defined in the method's own file.
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
std::unique_ptr<BroadPhase> make_refit(Executor& executor);
std::unique_ptr<BroadPhase> make_uniform_grid(Executor& executor);
std::unique_ptr<BroadPhase> make_lbvh_top_down(Executor& executor);

}  // namespace collidoscope

#include "sim_cuda/run/tree_probe.h"

#include <stdexcept>
#include <string>
#include <utility>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/run/broad_phase_times.h"
#include "sim_cuda/run/simulation.h"

namespace collidoscope {

std::int64_t TreeProbe::nodes() const { return run_.pipeline().tree_source().tree_nodes(); }

TreeLevels TreeProbe::levels() {
  run_.detect();
  const TreeView& tree = run_.level_ordered_tree();
  TreeLevels levels;
  for (int level = 0; level < tree.levels(); ++level) {
    static_assert(sizeof(TreeLevels::Box) == sizeof(Aabb));
    std::vector<TreeLevels::Box> boxes(tree.level_size(level));
    run_.executor.copy_to_host(boxes.data(), tree.box + tree.level_begin(level), boxes.size() * sizeof(Aabb));
    levels.levels.push_back(std::move(boxes));
  }
  return levels;
}

std::vector<std::int64_t> TreeProbe::level_sizes() {
  run_.detect();
  const TreeView& tree = run_.level_ordered_tree();
  std::vector<std::int64_t> sizes;
  for (int level = 0; level < tree.levels(); ++level) sizes.push_back(tree.level_size(level));
  return sizes;
}

const std::vector<std::int64_t>& TreeProbe::leaves() {
  run_.detect();
  return run_.bvh_cache().leaves(run_.pipeline().tree_source());
}

// ---- measures ----

const TreeQuality& TreeProbe::quality() {
  run_.detect();
  Pipeline& pipeline = run_.pipeline();
  return run_.bvh_cache().quality(pipeline.tree_source(), pipeline.broad_phase_bytes());
}

double TreeProbe::own_visits() {
  run_.detect();
  return run_.bvh_cache().own_visits(run_.pipeline().tree_source()).mean;
}

std::vector<NodeReport> TreeProbe::ranked(NodeMetric metric, std::int64_t first, std::int64_t count, int from,
                                          int to) {
  quality();
  return run_.bvh_cache().statistics().ranked(run_.level_ordered_tree(), metric, first, count, from, to);
}

std::vector<NodeReport> TreeProbe::nodes_at(const std::vector<std::uint32_t>& places) {
  quality();
  for (const std::uint32_t place : places)
    if (place >= nodes()) throw std::out_of_range("tree_node: no node " + std::to_string(place));
  return run_.bvh_cache().statistics().nodes(run_.level_ordered_tree(), places);
}

NodeReport TreeProbe::node(std::uint32_t place) { return nodes_at({place}).front(); }

NodeHistogram TreeProbe::node_histogram(NodeMetric metric, const NodeSelection& selection) {
  quality();
  return run_.bvh_cache().statistics().histogram(run_.level_ordered_tree(), metric, selection);
}

// ---- queries ----

std::vector<std::uint32_t> TreeProbe::visited(std::uint32_t id, std::int64_t limit) {
  quality();
  if (id >= run_.initial.size()) throw std::out_of_range("visited_nodes: no body " + std::to_string(id));
  return run_.bvh_cache().statistics().visited(run_.level_ordered_tree(), id, limit);
}

std::int64_t TreeProbe::visits_of(std::uint32_t id) {
  if (id >= run_.initial.size()) throw std::out_of_range("visits_of: no body " + std::to_string(id));
  return quality().nodes > 0 ? run_.bvh_cache().statistics().visits_of(id) : 0;
}

BroadPhaseTimes TreeProbe::time_broad_phase(int repeats) {
  run_.detect();  // grows lists if needed
  return collidoscope::time_broad_phase(run_.executor, run_.pipeline(), repeats);
}

std::vector<float> TreeProbe::time_queries(int repeats) {
  if (quality().nodes == 0) return {};
  return time_tree_queries(run_.executor, run_.level_ordered_tree(), run_.bvh_cache().statistics(), repeats);
}

}  // namespace collidoscope

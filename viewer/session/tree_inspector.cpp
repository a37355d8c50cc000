#include "viewer/session/tree_inspector.h"

#include <algorithm>

namespace collidoscope {
namespace {

bool overlap(const NodeReport& a, const NodeReport& b) {
  for (int k = 0; k < 3; ++k)
    if (a.min[k] > b.max[k] || b.min[k] > a.max[k]) return false;
  return true;
}

}  // namespace

bool TreeInspector::due(const State& now, const Workspace& workspace) const {
  if (!view_ || now.generation != state_.generation || !workspace.playing || workspace.tree.rank) return true;
  const std::chrono::duration<double, std::milli> since = Clock::now() - measured_at_;
  return since.count() > 4 * view_->took_ms;
}

void TreeInspector::refresh(World& world, int generation, Workspace& workspace) {
  TreeRequests& requests = workspace.tree;
  const State now{generation, world.steps()};
  if (!(selected_in_ == now)) requests.node.reset();  // the index belongs to another tree
  selected_in_ = now;
  if (!workspace.visible_panels.right || !workspace.visible_panels.tree) {
    if (view_) ++version_;
    view_.reset();
    requests.node.reset();
    requests.rank.reset();
    return;
  }
  if (!(now == state_) && !due(now, workspace)) return;
  const bool again = !view_ || !(now == state_);
  if (again) measure(world, now);
  fill_table(world, workspace);
  fill_histogram(world, workspace.layers);
  fill_node(world, workspace);
  fill_query(world, workspace);
  if (again) {
    view_->took_ms = std::chrono::duration<double, std::milli>(Clock::now() - measured_at_).count();
    measured_at_ = Clock::now();
  }
}

void TreeInspector::measure(World& world, const State& now) {
  measured_at_ = Clock::now();
  view_.emplace();
  view_->quality = world.tree().quality();
  view_->step = now.step;
  state_ = now;
  table_ = {};
  histogram_key_ = {};
  ++version_;
}

void TreeInspector::fill_table(World& world, Workspace& workspace) {
  TreeRequests& requests = workspace.tree;
  const FrameLayers& layers = workspace.layers;
  const std::vector<std::int64_t> sizes = world.tree().level_sizes();
  view_->ranked = 0;
  for (int level = 0; level < static_cast<int>(sizes.size()); ++level)
    if (level >= layers.first_level && level <= layers.last_level)
      view_->ranked += sizes[static_cast<std::size_t>(level)];
  const std::int64_t last = std::max<std::int64_t>(view_->ranked - 1, 0);
  if (requests.rank) {
    requests.rank = std::clamp<std::int64_t>(*requests.rank, 0, last);
    if (*requests.rank < requests.first || *requests.rank >= requests.first + TreePanelView::page)
      requests.first = *requests.rank / TreePanelView::page * TreePanelView::page;
  }
  const bool other_levels = table_.first >= 0 && (table_.first_level != layers.first_level ||
                                                  table_.last_level != layers.last_level);
  if (other_levels && !requests.rank) requests.first = 0;
  requests.first =
      std::clamp<std::int64_t>(requests.first, 0, last / TreePanelView::page * TreePanelView::page);
  const Table wanted{requests.sort, requests.first, layers.first_level, layers.last_level};
  if (!(wanted == table_)) {
    view_->rows = world.tree().ranked(requests.sort, requests.first, TreePanelView::page, layers.first_level,
                                      layers.last_level);
    view_->first = requests.first;
    table_ = wanted;
    ++version_;
  }
  if (!requests.rank) return;
  const auto row = static_cast<std::size_t>(*requests.rank - view_->first);
  requests.rank.reset();
  if (row >= view_->rows.size()) return;
  const NodeReport& chosen = view_->rows[row];
  requests.node.reset();
  workspace.selection.reset();
  if (chosen.children == 0)
    workspace.selection = chosen.body;
  else
    requests.node = chosen.node;
}

void TreeInspector::fill_histogram(World& world, const FrameLayers& layers) {
  const HistogramKey wanted{layers.box_color, layers.first_level, layers.last_level, layers.box_low,
                            layers.box_high};
  if (wanted == histogram_key_) return;
  view_->histogram = {};
  if (layers.box_color != NodeMetric::level && view_->quality.nodes > 0)
    view_->histogram = world.tree().node_histogram(
        layers.box_color, {layers.first_level, layers.last_level, layers.box_low, layers.box_high});
  histogram_key_ = wanted;
  ++version_;
}

void TreeInspector::fill_node(World& world, Workspace& workspace) {
  TreeRequests& requests = workspace.tree;
  if (requests.node && *requests.node >= static_cast<std::uint64_t>(view_->quality.nodes))
    requests.node.reset();
  if (view_->node.has_value() == requests.node.has_value() &&
      (!requests.node || view_->node->node == *requests.node))
    return;
  view_->node.reset();
  view_->children.clear();
  ++version_;
  if (!requests.node) return;
  const NodeReport node = world.tree().node(*requests.node);
  if (node.children == 0) {  // picked in the 3D view
    workspace.selection = node.body;
    requests.node.reset();
    return;
  }
  view_->node = node;
  std::vector<std::uint32_t> places;
  for (std::uint32_t k = 0; k < view_->node->children; ++k) places.push_back(view_->node->first_child + k);
  view_->children = world.tree().nodes_at(places);
}

void TreeInspector::fill_query(World& world, const Workspace& workspace) {
  const bool wanted = workspace.tree.query && workspace.selection && view_->quality.nodes > 0 &&
                      *workspace.selection < world.initial().size();
  const std::optional<std::uint32_t> body = wanted ? workspace.selection : std::nullopt;
  if (view_->queried == body) return;
  view_->queried = body;
  view_->visited.clear();
  view_->visits = 0;
  ++version_;
  if (!body) return;
  view_->visits = world.tree().visits_of(*body);
  const std::vector<NodeReport> nodes = world.tree().nodes_at(world.tree().visited(*body, view_->visits));
  const auto leaf =
      std::ranges::find_if(nodes, [&](const NodeReport& n) { return n.children == 0 && n.body == *body; });
  for (const NodeReport& node : nodes) {
    if (std::ssize(view_->visited) == TreePanelView::max_visited) break;
    view_->visited.push_back({node, leaf != nodes.end() && overlap(node, *leaf)});  // box of the queried body
  }
}

}  // namespace collidoscope

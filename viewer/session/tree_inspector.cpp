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
  if (!facts_ || now.generation != state_.generation || !workspace.playing || workspace.tree.rank)
    return true;
  const std::chrono::duration<double, std::milli> since = Clock::now() - measured_at_;
  return since.count() > 4 * facts_->took_ms;
}

void TreeInspector::refresh(World& world, int generation, Workspace& workspace) {
  TreeWishes& wishes = workspace.tree;
  const State now{generation, world.steps()};
  if (!(selected_in_ == now)) wishes.node.reset();  // it was of another tree
  selected_in_ = now;
  if (!workspace.folds.right || !workspace.folds.tree) {
    if (facts_) ++version_;
    facts_.reset();
    wishes.node.reset();
    wishes.rank.reset();
    return;
  }
  if (!(now == state_) && !due(now, workspace)) return;
  const bool again = !facts_ || !(now == state_);
  if (again) measure(world, now);
  fill_table(world, workspace);
  fill_spread(world, workspace.layers);
  fill_node(world, workspace);
  fill_query(world, workspace);
  if (again) {
    facts_->took_ms = std::chrono::duration<double, std::milli>(Clock::now() - measured_at_).count();
    measured_at_ = Clock::now();
  }
}

void TreeInspector::measure(World& world, const State& now) {
  measured_at_ = Clock::now();
  facts_.emplace();
  facts_->quality = world.tree().quality();
  facts_->step = now.step;
  state_ = now;
  table_ = {};
  spread_ = {};
  ++version_;
}

void TreeInspector::fill_table(World& world, Workspace& workspace) {
  TreeWishes& wishes = workspace.tree;
  const FrameLayers& layers = workspace.layers;
  const std::vector<std::int64_t> sizes = world.tree().level_sizes();
  facts_->ranked = 0;
  for (int level = 0; level < static_cast<int>(sizes.size()); ++level)
    if (level >= layers.first_level && level <= layers.last_level)
      facts_->ranked += sizes[static_cast<std::size_t>(level)];
  const std::int64_t last = std::max<std::int64_t>(facts_->ranked - 1, 0);
  if (wishes.rank) {
    wishes.rank = std::clamp<std::int64_t>(*wishes.rank, 0, last);
    if (*wishes.rank < wishes.first || *wishes.rank >= wishes.first + TreeFacts::page)
      wishes.first = *wishes.rank / TreeFacts::page * TreeFacts::page;
  }
  const bool other_levels = table_.first >= 0 && (table_.first_level != layers.first_level ||
                                                  table_.last_level != layers.last_level);
  if (other_levels && !wishes.rank) wishes.first = 0;
  wishes.first = std::clamp<std::int64_t>(wishes.first, 0, last / TreeFacts::page * TreeFacts::page);
  const Table wanted{wishes.sort, wishes.first, layers.first_level, layers.last_level};
  if (!(wanted == table_)) {
    facts_->rows = world.tree().ranked(wishes.sort, wishes.first, TreeFacts::page, layers.first_level,
                                       layers.last_level);
    facts_->first = wishes.first;
    table_ = wanted;
    ++version_;
  }
  if (!wishes.rank) return;
  const auto row = static_cast<std::size_t>(*wishes.rank - facts_->first);
  wishes.rank.reset();
  if (row >= facts_->rows.size()) return;
  const NodeReport& chosen = facts_->rows[row];
  wishes.node.reset();
  workspace.selection.reset();
  if (chosen.children == 0)
    workspace.selection = chosen.body;
  else
    wishes.node = chosen.node;
}

void TreeInspector::fill_spread(World& world, const FrameLayers& layers) {
  const Spread wanted{layers.box_color, layers.first_level, layers.last_level, layers.box_low,
                      layers.box_high};
  if (wanted == spread_) return;
  facts_->spread = {};
  if (layers.box_color != NodeMetric::level && facts_->quality.nodes > 0)
    facts_->spread = world.tree().spread(
        layers.box_color, {layers.first_level, layers.last_level, layers.box_low, layers.box_high});
  spread_ = wanted;
  ++version_;
}

void TreeInspector::fill_node(World& world, Workspace& workspace) {
  TreeWishes& wishes = workspace.tree;
  if (wishes.node && *wishes.node >= static_cast<std::uint64_t>(facts_->quality.nodes)) wishes.node.reset();
  if (facts_->node.has_value() == wishes.node.has_value() &&
      (!wishes.node || facts_->node->node == *wishes.node))
    return;
  facts_->node.reset();
  facts_->children.clear();
  ++version_;
  if (!wishes.node) return;
  const NodeReport node = world.tree().node(*wishes.node);
  if (node.children == 0) {  // picked in the picture
    workspace.selection = node.body;
    wishes.node.reset();
    return;
  }
  facts_->node = node;
  std::vector<std::uint32_t> places;
  for (std::uint32_t k = 0; k < facts_->node->children; ++k) places.push_back(facts_->node->first_child + k);
  facts_->children = world.tree().nodes_at(places);
}

void TreeInspector::fill_query(World& world, const Workspace& workspace) {
  const bool wanted = workspace.tree.query && workspace.selection && facts_->quality.nodes > 0 &&
                      *workspace.selection < world.initial().size();
  const std::optional<std::uint32_t> body = wanted ? workspace.selection : std::nullopt;
  if (facts_->queried == body) return;
  facts_->queried = body;
  facts_->visited.clear();
  facts_->visits = 0;
  ++version_;
  if (!body) return;
  facts_->visits = world.tree().visits_of(*body);
  const std::vector<NodeReport> nodes = world.tree().nodes_at(world.tree().visited(*body, facts_->visits));
  const auto leaf =
      std::ranges::find_if(nodes, [&](const NodeReport& n) { return n.children == 0 && n.body == *body; });
  for (const NodeReport& node : nodes) {
    if (std::ssize(facts_->visited) == TreeFacts::most_visited) break;
    facts_->visited.push_back({node, leaf != nodes.end() && overlap(node, *leaf)});  // its box is the query
  }
}

}  // namespace collidoscope

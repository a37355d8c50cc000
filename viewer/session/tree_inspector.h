#pragma once
// Measures the tree for the panel that shows it, while that is open, and nothing otherwise. A run that plays
// is measured at most a fifth of the time; a paused one at once. Owns what the panel shows.

#include <chrono>
#include <optional>

#include "sim_cuda/world.h"
#include "ui/workspace.h"

namespace collidoscope {

class TreeInspector {
 public:
  /// Brings facts() to the current state and to what the panel wishes for, where it is due, and meets those
  /// wishes that select something; a leaf selects its body. `generation`: another one, another World.
  void refresh(World& world, int generation, Workspace& workspace);
  const TreeFacts* facts() const { return facts_ ? &*facts_ : nullptr; }
  /// Changes whenever the facts do.
  int version() const { return version_; }

 private:
  using Clock = std::chrono::steady_clock;
  /// Of what the facts are; each part is asked for again when its key changes.
  struct State {
    int generation = -1;
    std::int64_t step = -1;
    friend bool operator==(const State&, const State&) = default;
  };
  struct Table {
    NodeMetric sort = NodeMetric::level;
    std::int64_t first = -1;
    int first_level = 0, last_level = 0;
    friend bool operator==(const Table&, const Table&) = default;
  };
  struct Spread {
    NodeMetric metric = NodeMetric::level;
    int first_level = -1, last_level = -1;
    float low = 0, high = 0;
    friend bool operator==(const Spread&, const Spread&) = default;
  };

  bool due(const State& now, const Workspace& workspace) const;
  void measure(World& world, const State& now);
  void fill_table(World& world, Workspace& workspace);
  void fill_spread(World& world, const FrameLayers& layers);
  void fill_node(World& world, Workspace& workspace);
  void fill_query(World& world, const Workspace& workspace);

  std::optional<TreeFacts> facts_;
  int version_ = 0;
  State state_, selected_in_;  ///< of the facts; of the selected node
  Table table_;
  Spread spread_;
  Clock::time_point measured_at_;
};

}  // namespace collidoscope

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
  /// Brings view() to the current state and to what the panel requests, where it is due, and meets those
  /// requests that select something; a leaf selects its body. `generation`: another one, another World.
  void refresh(World& world, int generation, Workspace& workspace);
  const TreePanelView* view() const { return view_ ? &*view_ : nullptr; }
  /// Changes whenever the view does.
  int version() const { return version_; }

 private:
  using Clock = std::chrono::steady_clock;
  /// What the view shows; each part is asked for again when its key changes.
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
  struct HistogramKey {
    NodeMetric metric = NodeMetric::level;
    int first_level = -1, last_level = -1;
    float low = 0, high = 0;
    friend bool operator==(const HistogramKey&, const HistogramKey&) = default;
  };

  bool due(const State& now, const Workspace& workspace) const;
  void measure(World& world, const State& now);
  void fill_table(World& world, Workspace& workspace);
  void fill_histogram(World& world, const FrameLayers& layers);
  void fill_node(World& world, Workspace& workspace);
  void fill_query(World& world, const Workspace& workspace);

  std::optional<TreePanelView> view_;
  int version_ = 0;
  State state_, selected_in_;  ///< of the view; of the selected node
  Table table_;
  HistogramKey histogram_key_;
  Clock::time_point measured_at_;
};

}  // namespace collidoscope

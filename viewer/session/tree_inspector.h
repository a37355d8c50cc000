#pragma once
// Measures the tree for its panel, only while the panel is open. During play it uses at most a fifth of the
// time; a paused run is measured at once. Owns the data of the panel.

#include <chrono>
#include <optional>

#include "sim_cuda/world.h"
#include "ui/workspace.h"

namespace collidoscope {

class TreeInspector {
 public:
  /// Updates view() to the current state and the panel's requests, when due. Handles selection requests;
  /// selecting a leaf selects its body. `generation` changes with each new World.
  void refresh(World& world, int generation, Workspace& workspace);
  const TreePanelView* view() const { return view_ ? &*view_ : nullptr; }
  /// Increases when the view changes.
  int version() const { return version_; }

 private:
  using Clock = std::chrono::steady_clock;
  /// Contents of the view. Each part is updated when its key changes.
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
  State state_, selected_in_;  ///< states of the view and of the selected node
  Table table_;
  HistogramKey histogram_key_;
  Clock::time_point measured_at_;
};

}  // namespace collidoscope

#pragma once
// Data of the launch map panel. Plain structs: the panel writes the requests, the caller writes the view.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/core/launch_shape.h"
#include "sim_cuda/tuning/launch_search.h"

namespace collidoscope {

/// Screen position of the centre of a drawn cell, in pixels.
struct LaunchMapPlace {
  std::size_t cell = 0;
  float x = 0, y = 0;
};

struct LaunchMapRequests {
  bool running = false;  ///< measure while the panel is open
  bool restart = false;  ///< measure a new map from the present state; cleared by the caller
  double budget = 5;     ///< s, of all measurements of a map together
  std::string stage;     ///< stage whose times are shown; empty: the whole step

  std::vector<LaunchMapPlace> places;  ///< drawn cells, for --automation
};

struct LaunchMapView {
  /// A stage that obeys (B, T).
  struct Stage {
    std::string name;
    double reference_ms = 0;
    LaunchShape reference_shape;    ///< 0: not known
    std::vector<double> cell_ms;    ///< by cell; NaN: not measured
    std::vector<double> occupancy;  ///< by cell, 0 to 1; 0: not known
  };
  std::vector<LaunchCell> cells;
  std::vector<std::size_t> plateau;   ///< cells that cannot be told apart from the best one
  std::optional<std::size_t> chosen;  ///< the one in its centre
  std::vector<Stage> stages;
  LaunchShape reference;         ///< all cells are compared with it; 0: automatic
  double reference_ms = 0;       ///< median of a step
  LaunchShape now;               ///< of the run
  std::int64_t start_state = 0;  ///< all measurements start from copies of it
  std::int64_t bodies = 0;
  double spent = 0, budget = 0;  ///< s
  bool begun = false, done = false;
  std::string verdict;                ///< of the confirmation; empty: there is none yet
  bool is_faster = false;             ///< the chosen cell, confirmed, than the reference
  std::string stage_verdict;          ///< of the best shape of each stage together; empty: there is none
  std::string stage_shapes;           ///< value of --stage-shapes
  std::string unavailable_reason;     ///< why nothing can be measured; empty: available
  std::vector<std::uint32_t> colors;  ///< of the scale, from slow to fast, 0xAABBGGRR
};

}  // namespace collidoscope

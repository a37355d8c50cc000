#pragma once
// Data of the accuracy panel. Plain structs: the panel writes the requests, the caller writes the view.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/accuracy/point.h"
#include "sim_cuda/scene/effects.h"

namespace collidoscope {

/// Screen position of a drawn element, in pixels.
struct AccuracyPlace {
  std::size_t point = 0;
  float x = 0, y = 0;
};

struct AccuracyRequests {
  double tolerance = 0;  ///< m, largest acceptable error; 0: unset, the caller sets a default
  bool running = true;   ///< measure while the panel is open
  bool restart = false;  ///< restart from the present state; cleared by the caller

  std::vector<AccuracyPlace> places;  ///< drawn points of the diagram, for --automation
  std::optional<AccuracyPlace> line;  ///< grip of the tolerance line
};

struct AccuracyView {
  std::vector<AccuracyPoint> points;           ///< coarse to fine, including those not measured yet
  std::optional<AccuracyReference> reference;  ///< unset while it is computed
  std::optional<std::size_t> cheapest;         ///< index of the recommended point below the tolerance
  std::string no_recommendation_reason;        ///< why no setting is recommended; empty: one is
  AccuracySetting now;                         ///< current setting of the run
  Effects effects;                             ///< effects of the run
  std::string executor;                        ///< executor that measures the costs
  std::int64_t start_state = 0;                ///< initial state of all measured runs
  double seconds = 0;                          ///< s, approximate simulated time of each run
  double done = 0;                             ///< completed share of the work, 0 to 1
  std::string current_task;                    ///< short text; empty: all is measured
  std::string unavailable_reason;              ///< why nothing can be measured; empty: available
  std::vector<std::string> warnings;           ///< warnings about the results, one line each
};

}  // namespace collidoscope

#pragma once
// What the panel of accuracy shows and asks for. Plain data: the requests are the panel's, the view its
// owner's.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/accuracy/point.h"
#include "sim_cuda/scene/effects.h"

namespace collidoscope {

/// Where something was drawn last, in pixels of the screen.
struct AccuracyPlace {
  std::size_t point = 0;
  float x = 0, y = 0;
};

struct AccuracyRequests {
  double tolerance = 0;  ///< m, the error that is allowed; 0: nobody said, and the owner sets one
  bool running = true;   ///< go on measuring while the panel is unfolded
  bool restart = false;  ///< from the bodies as they are; cleared by the owner

  std::vector<AccuracyPlace> places;  ///< of the points of the diagram, for whoever clicks by name
  std::optional<AccuracyPlace> line;  ///< of the grip of the line across
};

struct AccuracyView {
  std::vector<AccuracyPoint> points;           ///< coarse to fine, those that are not measured yet, too
  std::optional<AccuracyReference> reference;  ///< unset while it is being made
  std::optional<std::size_t> cheapest;         ///< of the points below the tolerance, if one is recommended
  std::string no_recommendation_reason;        ///< why none is; else empty
  AccuracySetting now;                         ///< of the run
  Effects effects;                             ///< of the run
  std::string executor;                        ///< where costs are measured
  std::int64_t start_state = 0;                ///< the state that all runs start from
  double seconds = 0;                          ///< s, how long they are about
  double done = 0;                             ///< share of the work, 0 to 1
  std::string current_task;                    ///< in a few words; empty: all is measured
  std::string unavailable_reason;              ///< why nothing can be measured, or empty
  std::vector<std::string> warnings;           ///< of the results, a line each
};

}  // namespace collidoscope

#pragma once
// The work-precision diagram: error over what a simulated second costs. A free function over plain data, for
// the panel and for pictures.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim_cuda/accuracy/point.h"
#include "ui/chart.h"

namespace collidoscope {

struct AccuracyChart {
  Chart chart;
  /// Of each series and place in it, which of the points.
  std::vector<std::vector<std::size_t>> points;
  /// What is told apart by colour: series, whatever their precision.
  struct Kind {
    std::string name;
    std::uint32_t color;
  };
  std::vector<Kind> kinds;
};

/// A colour for each kind of series; float is a solid line with discs, double a dashed one with diamonds. The
/// line of a series joins those of its points that no other of them beats in both; the rest are fainter. Bars
/// are the spread of the cost. The
/// Pareto front of all is a broad line below. `light`: the theme.
AccuracyChart accuracy_chart(std::span<const AccuracyPoint> points,
                             const std::optional<AccuracyReference>& reference, double tolerance, bool light);

/// 0.00123 m as "1.23 mm".
std::string length_text(double meters);

}  // namespace collidoscope

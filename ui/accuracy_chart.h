#pragma once
// The work-precision diagram: error versus cost of a simulated second. A free function over plain data, used
// by the panel and by pictures.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim_cuda/accuracy/point.h"
#include "ui/chart.h"

namespace collidoscope {

struct AccuracyChart {
  Chart chart;
  /// points[s][k]: index of the AccuracyPoint at point k of series s.
  std::vector<std::vector<std::size_t>> points;
  /// The series of one colour: all precisions of one solver and integrator.
  struct Kind {
    std::string name;
    std::uint32_t color;
  };
  std::vector<Kind> kinds;
};

/// The chart of all points. Each kind of series has a colour. Float: solid line, discs; double: dashed line,
/// diamonds. The line of a series joins its Pareto-optimal points; the other points are fainter. Bars show
/// the spread of the cost. The Pareto front of all points is a wide line below. `light`: theme.
AccuracyChart accuracy_chart(std::span<const AccuracyPoint> points,
                             const std::optional<AccuracyReference>& reference, double tolerance, bool light);

/// Length with SI prefix: 0.00123 m is "1.23 mm".
std::string length_text(double meters);

}  // namespace collidoscope

#include "ui/accuracy_chart.h"

#include <algorithm>
#include <cmath>

#include "ui/widgets.h"

namespace collidoscope {
namespace {

/// "soft_step rk4" for the series "soft_step rk4 f64".
std::string kind_of(const AccuracyPoint& point) {
  std::string kind = point.series_name;
  for (const char* precision : {" f32", " f64"})
    if (const std::size_t at = kind.find(precision); at != kind.npos) kind.erase(at, 4);
  return kind;
}

ChartPoint place_of(const AccuracyPoint& point) {
  ChartPoint place{point.ms.median, point.error};
  place.x_low = point.ms.low;
  place.x_high = point.ms.high;
  return place;
}

std::uint32_t faded(std::uint32_t color, std::uint32_t alpha) { return (color & 0x00ffffffu) | alpha << 24; }

}  // namespace

std::string length_text(double meters) { return with_prefix(meters, "m"); }

AccuracyChart accuracy_chart(std::span<const AccuracyPoint> points,
                             const std::optional<AccuracyReference>& reference, double tolerance,
                             bool light) {
  AccuracyChart result;
  Chart& chart = result.chart;
  chart.x = {"ms per simulated second", short_number, true};
  chart.y = {"rms error", length_text, true};
  chart.fits_error_bars = false;  // one disturbed run must not compress the chart
  chart.level = tolerance > 0 ? tolerance : no_value;
  chart.level_name = "tolerance " + length_text(tolerance);
  if (reference && reference->error > 0) {
    chart.floor = reference->error;
    chart.floor_name = "below reference error";
  }

  // Ascending cost, so that lines run to the right.
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < points.size(); ++k)
    if (points[k].has_error() && points[k].has_cost()) order.push_back(k);
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return points[k].ms.median; });

  const auto add = [&](const char* name, std::uint32_t color) -> ChartSeries& {
    chart.series.push_back({name, color, {}});
    result.points.emplace_back();
    return chart.series.back();
  };
  ChartSeries& front = add("Pareto front", light ? 0x60808080u : 0x60a0a0a0u);
  front.marks = false;
  front.broad = true;
  for (const std::size_t k : order) {
    if (!points[k].on_front) continue;
    front.points.push_back({points[k].ms.median, points[k].error});
    result.points.back().push_back(k);
  }

  std::vector<std::string> series_names;
  for (const AccuracyPoint& point : points) {
    if (std::ranges::find(series_names, point.series_name) != series_names.end()) continue;
    series_names.push_back(point.series_name);
    const std::string name = kind_of(point);
    auto kind = std::ranges::find(result.kinds, name, &AccuracyChart::Kind::name);
    if (kind == result.kinds.end()) {
      result.kinds.push_back({name, stage_color(result.kinds.size(), light)});
      kind = result.kinds.end() - 1;
    }
    const bool fine = point.setting.precision == Precision::f64;
    for (const bool best : {false, true}) {
      ChartSeries& series = add(point.series_name.c_str(), best ? kind->color : faded(kind->color, 0x70));
      series.line = best;
      series.dashed = fine;
      series.mark = fine ? 2 : 0;
      double least = std::numeric_limits<double>::infinity();
      for (const std::size_t k : order) {
        if (points[k].series_name != point.series_name) continue;
        const bool better = points[k].error < least;
        least = std::min(least, points[k].error);
        if (better != best) continue;
        ChartPoint place = place_of(points[k]);
        if (!best) place.x_low = place.x_high = no_value;
        series.points.push_back(place);
        result.points.back().push_back(k);
      }
    }
  }
  return result;
}

}  // namespace collidoscope

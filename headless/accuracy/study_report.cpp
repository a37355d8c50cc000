#include "headless/accuracy/study_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "headless/reporting/report.h"
#include "sim_cuda/accuracy/errors.h"
#include "sim_cuda/core/statistics.h"
#include "sim_cuda/scene/names.h"
#include "ui/accuracy_chart.h"

namespace collidoscope {
namespace {

std::string number(double value) { return std::isfinite(value) ? fmt::format("{:.2e}", value) : "-"; }

/// Exact decimal for CSV; empty if unknown.
std::string csv_cell(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }

std::string cost_text(const AccuracyCost& ms) {
  if (!std::isfinite(ms.median)) return "-";
  return fmt::format("{:.4g} ({:.4g}-{:.4g})", ms.median, ms.low, ms.high);
}

/// Number of runs per cost; lower than requested if the study was interrupted.
std::string runs_text(const AccuracyRecord& record) {
  std::size_t least = static_cast<std::size_t>(record.rounds), most = 0;
  for (const AccuracyPoint& point : record.points) {
    if (!point.has_cost()) continue;
    least = std::min(least, point.ms_runs.size());
    most = std::max(most, point.ms_runs.size());
  }
  if (most == 0) return "not timed yet";
  if (most == 1) return "one run per setting";
  return "median of " +
         (least < most ? fmt::format("{} to {} runs", least, most) : fmt::format("{} runs", most));
}

std::string head_text(const AccuracyRecord& record) {
  const AccuracyReference& r = record.reference;
  std::string text = fmt::format("{}, N = {}; {}, {}\n", record.scene, grouped(record.bodies),
                                 record.executor, runs_text(record));
  text += fmt::format("reference: {}\n", r.description);
  text += fmt::format("positions compared over {:.3g} s", r.horizon);
  if (r.seconds > r.horizon) text += fmt::format(", energy and distributions over {:.3g} s", r.seconds);
  if (!r.end.empty()) text += fmt::format(": {}", r.end);
  text += fmt::format("\nerror of the reference: {} m", number(r.error));
  if (std::isfinite(r.order)) text += fmt::format(", observed order {:.2f}", r.order);
  if (r.lyapunov_rate > 0) text += fmt::format("; Lyapunov time {:.2g} s", 1 / r.lyapunov_rate);
  return text + "\n";
}

/// Observed order: slope of a series' error over the time step, other settings equal. Uses double only,
/// because rounding hides the order in float. Ignores errors near the reference's own error.
double order_of(const AccuracyRecord& record, const std::string& series_name) {
  double order = not_known;
  std::size_t longest = 2;  // points; at least three are required
  for (const AccuracyPoint& first : record.points) {
    if (first.series_name != series_name || first.setting.precision != Precision::f64) continue;
    std::vector<double> steps, errors;
    for (const AccuracyPoint& p : record.points) {
      if (p.series_name != series_name || p.setting.substeps != first.setting.substeps ||
          p.setting.iterations != first.setting.iterations || !std::isfinite(p.error) ||
          !(p.error > 3 * record.reference.error))
        continue;
      steps.push_back(p.setting.time_step);
      errors.push_back(p.error);
    }
    if (steps.size() <= longest) continue;
    longest = steps.size();
    order = fitted_order(steps, errors);
  }
  return order;
}

std::vector<std::string> series_of(const AccuracyRecord& record) {
  std::vector<std::string> series_names;
  for (const AccuracyPoint& p : record.points)
    if (std::ranges::find(series_names, p.series_name) == series_names.end())
      series_names.push_back(p.series_name);
  std::ranges::sort(series_names);
  return series_names;
}

std::string row_text(const AccuracyPoint& p) {
  const AccuracyInvariants& i = p.invariants;
  const double joints = std::isfinite(i.joint_error) ? i.joint_error : i.penetration_max;
  return fmt::format("{} {:<33}{:>9}{:>9}  {:<25}{:>9}{:>9}{:>9}\n", p.on_front ? '*' : ' ', p.name,
                     p.has_error() && !std::isfinite(p.error) ? "diverged" : number(p.error),
                     number(p.error_worst), cost_text(p.ms), number(i.energy_error),
                     number(i.momentum_balance), number(joints));
}

std::string cheapest_text(const AccuracyRecord& record, double tolerance) {
  const Recommendation answer = recommended(record.points, record.reference.error, tolerance);
  if (!answer.point) return answer.unavailable_reason;
  const AccuracyPoint& p = record.points[*answer.point];
  return fmt::format("fastest setting within {:g} m: {}, {}; error {} m, {:.4g} ms per simulated second",
                     tolerance, p.series_name, p.name, number(p.error), p.ms.median);
}

std::string float_text(const AccuracyRecord& record) {
  constexpr double worse = 1.25;
  std::vector<double> ratios;
  double departs = 0;
  int pairs = 0;
  for (const AccuracyPoint& f : record.points) {
    if (f.setting.precision != Precision::f32) continue;
    for (const AccuracyPoint& d : record.points) {
      AccuracySetting other = d.setting;
      other.precision = Precision::f32;
      if (d.setting.precision != Precision::f64 || !(other == f.setting)) continue;
      if (f.has_cost() && d.has_cost()) ratios.push_back(d.ms.median / f.ms.median);
      if (!std::isfinite(f.error) || !std::isfinite(d.error)) continue;
      ++pairs;
      if (f.error > worse * d.error) departs = std::max(departs, f.error);
    }
  }
  if (pairs == 0 || ratios.empty()) return "";
  return fmt::format("f64 takes {:.2f} times as long as f32 (median of {} settings); {}\n",
                     quantile(ratios, 0.5, not_known), ratios.size(),
                     departs > 0 ? fmt::format("the largest f32 error that exceeds the f64 error by more "
                                               "than 25 % is {} m",
                                               number(departs))
                                 : "the f32 error is at most 25 % above the f64 error at every setting");
}

/// The Pareto front, from cheap to expensive.
std::vector<const AccuracyPoint*> front_of(const AccuracyRecord& record) {
  std::vector<const AccuracyPoint*> front;
  for (const AccuracyPoint& p : record.points)
    if (p.on_front) front.push_back(&p);
  std::ranges::sort(front, {}, [](const AccuracyPoint* p) { return p->ms.median; });
  return front;
}

}  // namespace

std::string study_text(const AccuracyRecord& record, std::optional<double> tolerance) {
  std::string text = head_text(record);
  const bool joints = std::ranges::any_of(
      record.points, [](const AccuracyPoint& p) { return std::isfinite(p.invariants.joint_error); });
  text += fmt::format("\n  {:<33}{:>9}{:>9}  {:<25}{:>9}{:>9}{:>9}\n", "", "error, m", "max, m",
                      "ms per simulated second", "energy", "momentum", joints ? "joint, m" : "depth, m");
  for (const std::string& series_name : series_of(record)) {
    const double order = order_of(record, series_name);
    text += series_name + (std::isfinite(order) ? fmt::format(", observed order {:.2f}", order) : "") + "\n";
    for (const AccuracyPoint& p : record.points)
      if (p.series_name == series_name) text += row_text(p);
  }
  text +=
      "* Pareto-optimal: no other setting is both faster and more accurate. error: root mean square of the\n"
      "  distance to the reference over bodies and time; energy: difference to the reference, over its\n"
      "  largest kinetic energy; momentum: change not due to walls or gravity, over the sum of m |v|\n\n";
  text += "Pareto front, fastest first:\n";
  for (const AccuracyPoint* p : front_of(record))
    text += fmt::format("  {:<60}{:>9} m {:>9.4g} ms\n", p->series_name + ", " + p->name, number(p->error),
                        p->ms.median);
  text += "\n" + float_text(record);
  if (!tolerance && all_below_reference(record.points, record.reference.error))
    text += recommended(record.points, record.reference.error, 0).unavailable_reason + "\n";
  for (const std::string& warning : record.warnings) text += warning + "\n";
  if (tolerance) text += cheapest_text(record, *tolerance) + "\n";
  return text;
}

std::string study_csv(const AccuracyRecord& record) {
  std::string text =
      "series,name,time_step,substeps,iterations,solver,integrator,rotation_update,precision,"
      "continuous_collision,error,error_low,error_high,error_worst,ms_per_second,ms_low,ms_high,"
      "energy_drift,energy_error,momentum_balance,angular_momentum_balance,angular_momentum_error,"
      "penetration_max,penetration_rms,penetration_over_radius,joint_error,joint_angle,cone_violation,"
      "heights,speeds,on_front\n";
  for (const AccuracyPoint& p : record.points) {
    const AccuracySetting& s = p.setting;
    const AccuracyInvariants& i = p.invariants;
    text +=
        fmt::format("{},\"{}\",{},{},{},{},{},{},{},{}", p.series_name, p.name, s.time_step, s.substeps,
                    s.iterations, name_of(solver_names, s.solver), name_of(integrator_names, s.integrator),
                    name_of(rotation_update_names, s.rotation_update), name_of(precision_names, s.precision),
                    s.continuous_collision);
    for (const double value : {p.error,
                               p.error_low,
                               p.error_high,
                               p.error_worst,
                               p.ms.median,
                               p.ms.low,
                               p.ms.high,
                               i.energy_drift,
                               i.energy_error,
                               i.momentum_balance,
                               i.angular_momentum_balance,
                               i.angular_momentum_error,
                               i.penetration_max,
                               i.penetration_rms,
                               i.penetration_over_radius,
                               i.joint_error,
                               i.joint_angle,
                               i.cone_violation,
                               p.distributions.heights,
                               p.distributions.speeds})
      text += "," + csv_cell(value);
    text += fmt::format(",{}\n", p.on_front);
  }
  return text;
}

std::string study_markdown(const AccuracyRecord& record, std::optional<double> tolerance) {
  std::string text = head_text(record);
  std::ranges::replace(text, '\n', ' ');
  text +=
      "\n\n| setting | error, m | max. error, m | ms per simulated second | energy error | overlap / radius "
      "|\n"
      "|---|---:|---:|---:|---:|---:|\n";
  for (const AccuracyPoint* p : front_of(record))
    text += fmt::format("| `{}`, {} | {:.2g} | {:.2g} | {} | {:.2g} | {:.2g} |\n", p->series_name, p->name,
                        p->error, p->error_worst, cost_text(p->ms), p->invariants.energy_error,
                        p->invariants.penetration_over_radius);
  text += "\n" + float_text(record);
  if (tolerance) text += cheapest_text(record, *tolerance) + "\n";
  return text;
}

Chart study_chart(const AccuracyRecord& record, std::optional<double> tolerance) {
  const AccuracyReference& reference = record.reference;
  AccuracyChart made = accuracy_chart(record.points, reference, tolerance.value_or(0), true);
  Chart& chart = made.chart;
  chart.title = fmt::format("{}, N = {}: what accuracy costs", record.scene, grouped(record.bodies));
  chart.note = fmt::format("{}; {:.3g} s; {}, {}; dashed: f64; thick line: Pareto front",
                           reference.kind == AccuracyReference::Kind::hard_spheres
                               ? "reference: event-driven hard spheres"
                               : "reference: converged run",
                           reference.horizon, record.executor, runs_text(record));
  for (std::size_t s = 0; s < chart.series.size(); ++s) {
    ChartSeries& series = chart.series[s];
    if (!series.line || !series.marks) {
      series.name.clear();  // the front, and dominated points of each series
      continue;
    }
    for (std::size_t k = 0; k < series.points.size(); ++k) {
      const AccuracyPoint& point = record.points[made.points[s][k]];
      series.points[k].y_low = point.error_low;
      series.points[k].y_high = point.error_high;
    }
  }
  // Hide the reference's error if it is not finite or far below all other errors.
  if (!std::isfinite(chart.floor)) return chart;
  double least = std::numeric_limits<double>::infinity();
  for (const AccuracyPoint& p : record.points) least = p.error < least ? p.error : least;
  if (chart.floor < least / 30) chart.floor = no_value;
  return chart;
}

}  // namespace collidoscope

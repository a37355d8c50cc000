#include "headless/accuracy/analytic_suite.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "headless/cli/progress.h"
#include "headless/cli/standard_output.h"
#include "headless/pictures/chart_picture.h"
#include "headless/reporting/report.h"
#include "headless/reporting/result_files.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/reference/analytic_cases.h"
#include "sim_cuda/scene/names.h"

namespace collidoscope {
namespace {

using Json = nlohmann::ordered_json;

const char* name_of_claim(Claim claim) {
  switch (claim) {
    case Claim::exact:
      return "exact";
    case Claim::leading:
      return "leading";
    case Claim::bound:
      return "bound";
  }
  return "";
}

/// Theoretical error. NaN if the theory predicts rounding errors only.
double theory_at(const AnalyticResult& r, const AnalyticLevel& level) {
  return r.method.theory.claim == Claim::exact ? std::nan("") : r.method.theory.error(level.h);
}

/// "1/30", or "1000".
std::string step_text(double h) {
  const double rate = std::round(1 / h);
  return rate >= 2 && std::abs(rate * h - 1) < 1e-9 ? fmt::format("1/{:.0f}", rate)
                                                    : fmt::format("{:.4g}", h);
}

/// Two digits: 220 instead of 2.2e+02.
std::string error_text(double error) {
  return error >= 10 && error < 1e5 ? fmt::format("{:.0f}", error) : fmt::format("{:.2g}", error);
}
std::string span_text(const AnalyticResult& r, const char* between) {
  return error_text(r.levels.front().error) + between + error_text(r.levels.back().error);
}

std::string order_text(const AnalyticResult& r) {
  switch (r.method.theory.claim) {
    case Claim::exact:
      return "exact";
    case Claim::leading:
      return r.precision == Precision::f64
                 ? fmt::format("{:.2f} of {:g}", r.fitted_order, r.method.theory.order)
                 : fmt::format("of {:g}", r.method.theory.order);
    case Claim::bound:
      return fmt::format("bound, {:g}", r.method.theory.order);
  }
  return "";
}

/// Ratio of the measured to the theoretical error at the smallest step.
std::string share_text(const AnalyticResult& r) {
  const AnalyticLevel& last = r.levels.back();
  return r.method.theory.claim == Claim::exact ? "" : fmt::format("{:.2f}", last.error / theory_at(r, last));
}

/// Results of one case and method.
struct AnalyticRow {
  const AnalyticResult* f64 = nullptr;
  const AnalyticResult* f32 = nullptr;
  const AnalyticResult& any() const { return f64 ? *f64 : *f32; }
  bool passed() const { return (!f64 || f64->passed()) && (!f32 || f32->passed()); }
};

/// The smallest step at which float is about as accurate as double. Blank if all errors are rounding errors,
/// or if there is no such step.
std::string float_pays_to(const AnalyticRow& row) {
  std::string step;
  if (!row.f64 || !row.f32 || row.f64->method.theory.claim == Claim::exact) return step;
  for (std::size_t k = 0; k < row.f64->levels.size(); ++k)
    if (row.f32->levels[k].error < 2 * row.f64->levels[k].error) step = step_text(row.f64->levels[k].h);
  return step;
}

std::vector<AnalyticRow> analytic_rows(const std::vector<AnalyticResult>& results) {
  std::vector<AnalyticRow> rows;
  for (const AnalyticResult& r : results) {
    if (rows.empty() || rows.back().any().name != r.name ||
        name_of(rows.back().any().method) != name_of(r.method))
      rows.emplace_back();
    (r.precision == Precision::f64 ? rows.back().f64 : rows.back().f32) = &r;
  }
  return rows;
}

struct Counts {
  std::size_t cases = 0, rows = 0, failed = 0;
  explicit Counts(const std::vector<AnalyticResult>& results) : rows(results.size()) {
    for (std::size_t k = 0; k < results.size(); ++k) {
      cases += k == 0 || results[k].name != results[k - 1].name ? 1 : 0;
      failed += results[k].passed() ? 0 : 1;
    }
  }
  std::string text(const std::string& device) const {
    return fmt::format("Analytic suite on {}: {} cases, {} runs at {} step sizes each, {}", device, cases,
                       rows, analytic_levels, failed == 0 ? "all pass" : fmt::format("{} failed", failed));
  }
};

/// Rejects flags that would change the scenes and steps of the cases.
void refuse_settings_of_cases(const Options& options) {
  std::vector<std::pair<std::string, bool>> flags;
  options.overrides.settings.for_each_set([&]<auto member>(const Field<member>& setting, const auto&) {
    if (!is_field<member, &Physics::integrator, &Physics::solver, &Physics::precision>)
      flags.emplace_back(flag_name(setting.name), true);
  });
  flags.emplace_back("--tolerance", options.accuracy.tolerance.has_value());
  flags.emplace_back("--seconds", options.accuracy.seconds != 0);
  std::vector<std::string> faults;
  for (const auto& [flag, given] : flags)
    if (given)
      faults.push_back(fmt::format(
          "{}: set by the analytic cases of accuracy without SCENE; give SCENE or remove the flag", flag));
  if (!faults.empty()) throw InputError(faults);
}

}  // namespace

std::string analytic_json(const std::vector<AnalyticResult>& results, const std::string& device) {
  Json json{{"suite", "analytic"},
            {"physics_version", physics_version},
            {"device", device},
            {"failed", Counts(results).failed},
            {"order_tolerance", order_tolerance},
            {"cases", Json::array()}};
  for (const AnalyticResult& r : results) {
    Json levels = Json::array();
    for (const AnalyticLevel& level : r.levels)
      levels.push_back({{"h", level.h},
                        {"steps", level.steps},
                        {"error", level.error},
                        {"theory", theory_at(r, level)},
                        {"tolerance", level.tolerance}});
    const bool exact = r.method.theory.claim == Claim::exact;
    json["cases"].push_back({{"name", r.name},
                             {"compared", r.compared},
                             {"because", r.rationale},
                             {"integrator", integrator_of(r.method)},
                             {"solver", name_of(solver_names, r.method.solver)},
                             {"precision", name_of(precision_names, r.precision)},
                             {"claim", name_of_claim(r.method.theory.claim)},
                             {"order", exact ? std::nan("") : r.method.theory.order},
                             {"fitted_order", r.fitted_order},
                             {"passed", r.passed()},
                             {"fault", r.fault},
                             {"levels", std::move(levels)}});
  }
  return json_text(json);
}

std::string analytic_csv(const std::vector<AnalyticResult>& results) {
  std::string text =
      "case,integrator,solver,precision,claim,order,fitted_order,h,steps,error,theory,tolerance,passed\n";
  const auto number = [](double x) { return std::isfinite(x) ? fmt::format("{}", x) : std::string(); };
  const auto field = [](const std::string& name) {
    return name.find(',') == name.npos ? name : fmt::format("\"{}\"", name);
  };
  for (const AnalyticResult& r : results)
    for (const AnalyticLevel& level : r.levels)
      text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", r.name, field(integrator_of(r.method)),
                          name_of(solver_names, r.method.solver), name_of(precision_names, r.precision),
                          name_of_claim(r.method.theory.claim),
                          r.method.theory.claim == Claim::exact ? "" : number(r.method.theory.order),
                          number(r.fitted_order), level.h, level.steps, level.error,
                          number(theory_at(r, level)), level.tolerance, r.passed() ? 1 : 0);
  return text;
}

std::string analytic_markdown(const std::vector<AnalyticResult>& results, const std::string& device) {
  std::string text =
      Counts(results).text(device) +
      ".\n\n| case: quantity | method | order | smallest h, s | f64 error | f64 error / theory | "
      "f32 error | f32 limit of h, s | reason |\n|---|---|---:|---:|---:|---:|---:|---:|---|\n";
  std::string last;
  for (const AnalyticRow& row : analytic_rows(results)) {
    const AnalyticResult& r = row.any();
    const bool again = r.name == last;
    last = r.name;
    text += fmt::format("| {} | {} | {}{} | {} | {} | {} | {} | {} | {} |\n",
                        again ? "" : fmt::format("`{}`: {}", r.name, r.compared), name_of(r.method),
                        order_text(r), row.passed() ? "" : ", **failed**", step_text(r.levels.back().h),
                        row.f64 ? error_text(row.f64->levels.back().error) : "", share_text(r),
                        row.f32 ? error_text(row.f32->levels.back().error) : "", float_pays_to(row),
                        again ? "" : r.rationale);
  }
  return text;
}

std::string analytic_text(const std::vector<AnalyticResult>& results, const std::string& device) {
  constexpr const char* columns = "{:<21}{:<44}{:<16}{:<18}{:>10}{:>11}{:>10}{:>10}  {:<8}{}\n";
  std::string text = fmt::format(columns, "case", "method", "h, s", "f64 error", "order", "/ theory",
                                 "f32 error", "f32 limit", "", "quantity");
  std::string last;
  for (const AnalyticRow& row : analytic_rows(results)) {
    const AnalyticResult& r = row.any();
    const bool again = r.name == last;
    last = r.name;
    text += fmt::format(columns, again ? "" : r.name, name_of(r.method),
                        fmt::format("{} - {}", step_text(r.levels.front().h), step_text(r.levels.back().h)),
                        row.f64 ? span_text(*row.f64, " - ") : "", order_text(r), share_text(r),
                        row.f32 ? error_text(row.f32->levels.back().error) : "", float_pays_to(row),
                        row.passed() ? "ok" : "FAILED", again ? "" : r.compared);
  }
  text += fmt::format("\n{}.\n", Counts(results).text(device));
  for (const AnalyticResult& r : results)
    if (!r.passed())
      text += fmt::format("{}, {}, {}: {}\n", r.name, name_of(r.method),
                          name_of(precision_names, r.precision), r.fault);
  return text;
}

Chart analytic_chart(const std::vector<AnalyticResult>& results, const std::string& name) {
  Chart chart;
  chart.x = {"time step, s", [](double h) { return step_text(h); }, true};
  chart.y = {"", [](double error) { return fmt::format("{:g}", error); }, true};
  std::vector<std::string> methods;
  for (const AnalyticResult& r : results) {
    if (r.name != name) continue;
    chart.title = r.name + ": slope = order; dashed: f32";
    chart.y.label = "error of " + r.compared;
    const std::string method = name_of(r.method);
    if (methods.empty() || methods.back() != method) methods.push_back(method);
    const bool f64 = r.precision == Precision::f64;
    ChartSeries line;
    line.name = method + (f64 ? ", f64" : ", f32");
    line.color = chart_color(methods.size() - 1);
    line.dashed = !f64;
    for (auto level = r.levels.rbegin(); level != r.levels.rend(); ++level)
      line.points.push_back({level->h, level->error});
    chart.series.push_back(std::move(line));
  }
  return chart;
}

int analytic_suite(const CommandLine& line) {
  const SettingsPatch& chosen = line.options.overrides.settings;
  refuse_settings_of_cases(line.options);
  const ResultFiles files(line.options);
  struct Run {
    const AnalyticCase* one;
    const AnalyticMethod* method;
    Precision precision;
  };
  const std::vector<AnalyticCase> cases = analytic_cases();
  std::vector<Run> runs;
  for (const AnalyticCase& one : cases)
    for (const AnalyticMethod& method : one.methods)
      for (const Precision precision : {Precision::f64, Precision::f32})
        if (chosen.get<&Physics::integrator>().value_or(method.integrator) == method.integrator &&
            chosen.get<&Physics::solver>().value_or(method.solver) == method.solver &&
            chosen.get<&Physics::precision>().value_or(precision) == precision)
          runs.push_back({&one, &method, precision});
  if (runs.empty())
    throw InputError("--integrator, --solver: no analytic case runs with both; expected one of them");

  std::vector<AnalyticResult> results;
  {
    Progress progress("runs", static_cast<std::int64_t>(runs.size()));
    for (const Run& run : runs) {
      results.push_back(run_case(*run.one, *run.method, run.precision, line.options.run));
      progress.update(static_cast<std::int64_t>(results.size()));
    }
  }
  const std::string device = World(cases[0].scene, line.options.run).info().device_name;
  const std::string json = analytic_json(results, device);
  files.write(json, analytic_csv(results), analytic_markdown(results, device));
  files.plot(analytic_chart(results, "orbit"));
  print(line.options.json == "-" ? json : analytic_text(results, device));
  return std::ranges::all_of(results, &AnalyticResult::passed) ? 0 : 1;
}

}  // namespace collidoscope

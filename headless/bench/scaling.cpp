#include "headless/bench/scaling.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "headless/bench/growth.h"
#include "headless/bench/method_row.h"
#include "headless/cli/standard_output.h"
#include "headless/reporting/report.h"
#include "headless/reporting/result_files.h"
#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/world.h"

namespace collidoscope {
namespace {

using Json = nlohmann::ordered_json;

struct Line {
  std::string method, variant;
  std::vector<Sample> samples;  ///< us
  Growth growth;
};

std::vector<Line> lines_of(const std::vector<MethodRow>& rows) {
  std::vector<Line> lines;
  for (const MethodRow& r : rows) {
    auto line = std::ranges::find_if(
        lines, [&](const Line& l) { return l.method == r.method && l.variant == r.variant; });
    if (line == lines.end()) line = lines.insert(lines.end(), {r.method, r.variant, {}, {}});
    line->samples.push_back({static_cast<double>(r.bodies), r.whole.median});
  }
  for (Line& line : lines) line.growth = fit_growth(line.samples);
  return lines;
}

bool is_fitted(const Growth& growth) { return growth.exponent > 0; }

std::string scaling_json(const BenchMachine& machine, const std::vector<MethodRow>& rows) {
  Json json{{"suite", "scaling"},
            {"physics_version", physics_version},
            {"executor", machine.executor},
            {"device", machine.device},
            {"plugins", machine.plugins},
            {"blocks", machine.shape.blocks},
            {"threads", machine.shape.threads},
            {"growth", Json::array()},
            {"rows", Json::array()}};
  for (const Line& line : lines_of(rows)) {
    const auto fitted = [&](double value) { return is_fitted(line.growth) ? Json(value) : Json(nullptr); };
    json["growth"].push_back({{"method", line.method},
                              {"variant", line.variant},
                              {"fixed_us", fitted(line.growth.fixed)},
                              {"scale_us", fitted(line.growth.scale)},
                              {"exponent", fitted(line.growth.exponent)},
                              {"exponent_least", fitted(line.growth.exponent_least)},
                              {"exponent_most", fitted(line.growth.exponent_most)},
                              {"relative_error", fitted(line.growth.error)}});
  }
  for (const MethodRow& row : rows) json["rows"].push_back(json_of(row));
  return json_text(json);
}

std::string exponent_text(const Growth& g) {
  if (!is_fitted(g)) return "too few sizes";
  return fmt::format("{:.2f} ({:.2f} to {:.2f})", g.exponent, g.exponent_least, g.exponent_most);
}
std::string fixed_text(const Growth& g) { return is_fitted(g) ? fmt::format("{:.1f}", g.fixed) : "-"; }
std::string error_text(const Growth& g) {
  return is_fitted(g) ? fmt::format("{:.1f} %", 100 * g.error) : "-";
}
double ns_a_body(const Line& line) { return 1000 * line.samples.back().time / line.samples.back().n; }

std::string growth_text(const std::vector<MethodRow>& rows) {
  std::string text = fmt::format("{:<20}{:<8}{:>12}{:>24}{:>12}{:>18}\n", "method", "variant", "fixed µs",
                                 "exponent of N", "fit error", "ns/body at max N");
  for (const Line& line : lines_of(rows))
    text += fmt::format("{:<20}{:<8}{:>11}{:>24}{:>12}{:>18.2f}\n", line.method, line.variant,
                        fixed_text(line.growth), exponent_text(line.growth), error_text(line.growth),
                        ns_a_body(line));
  return text;
}

std::string scaling_markdown(const BenchMachine& machine, const std::vector<MethodRow>& rows) {
  std::string text = fmt::format(
      "{}; fit: µs = fixed + scale N^exponent. Brackets: range of exponents with one N omitted.\n\n"
      "| variant | method | fixed, µs | exponent | fit error | ns per body at N = {} |\n"
      "|---|---|---:|---:|---:|---:|\n",
      text_of(machine), grouped(rows.back().bodies));
  for (const Line& line : lines_of(rows))
    text += fmt::format("| `{}` | `{}` | {} | {} | {} | {} |\n", line.variant, line.method,
                        fixed_text(line.growth), exponent_text(line.growth), error_text(line.growth),
                        line.samples.back().n == static_cast<double>(rows.back().bodies)
                            ? fmt::format("{:.2f}", ns_a_body(line))
                            : "–");
  return text;
}

Chart scaling_chart(const BenchMachine& machine, const std::vector<MethodRow>& rows) {
  Chart chart =
      chart_of_methods("Growth with N: time from positions to the ordered list of pairs", machine, rows);
  const std::vector<Line> lines = lines_of(rows);  // in the order of the chart's series
  for (std::size_t k = 0; k < lines.size(); ++k)
    if (is_fitted(lines[k].growth))
      chart.series[k].name += fmt::format("  N^{:.2f}", lines[k].growth.exponent);
  return chart;
}

}  // namespace

int bench_scaling(const CommandLine& line) {
  const ResultFiles files(line.options);
  const std::vector<std::string> methods = broad_phase_names(line.options.run.executor);
  std::vector<MethodRow> rows;
  BenchMachine machine;
  std::vector<std::int64_t> sizes{1'000, 2'000, 5'000, 10'000, 20'000, 50'000, 100'000};
  // GPU times below a million bodies are dominated by launches. Methods that test all pairs stop at smaller
  // sizes.
  if (World(load_scene(line), line.options.run).info().on_gpu)
    sizes = {1'000, 3'000, 10'000, 30'000, 100'000, 300'000, 1'000'000, 3'000'000, 10'000'000};
  sweep(line, {sizes, methods, {}}, [&](const SweepPoint& at) {
    if (rows.empty()) machine = machine_of(World(at.scene, at.run));
    rows.push_back(measure_method(at, static_cast<int>(line.options.bench.repeats)));
    files.write(scaling_json(machine, rows), csv_of(rows), scaling_markdown(machine, rows));
  });
  files.plot(scaling_chart(machine, rows));
  if (line.options.json == "-")
    print(scaling_json(machine, rows));
  else
    print(fmt::format("{}\n{}", text_of(machine), growth_text(rows)));
  return 0;
}

}  // namespace collidoscope

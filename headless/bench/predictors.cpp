#include "headless/bench/predictors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "headless/bench/method_row.h"
#include "headless/bench/rank_correlation.h"
#include "headless/cli/standard_output.h"
#include "headless/pictures/chart_picture.h"
#include "headless/reporting/report.h"
#include "headless/reporting/result_files.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/world.h"

namespace collidoscope {
namespace {

using Json = nlohmann::ordered_json;

struct PredictorRow {
  std::string method, variant;
  TreeQuality quality;
  double own_ns = 0, same_ns = 0;  ///< ns per query: own query with pair ordering; common query
};

/// A value of individual queries; NaN if the method does not provide them.
double by_query(const TreeQuality& q, double value) {
  return q.own.by_query ? value : std::numeric_limits<double>::quiet_NaN();
}

/// A candidate predictor of the time: larger means slower. NaN: not available for this tree.
struct Measure {
  const char* name;
  double (*of)(const TreeQuality&);
};
constexpr Measure measures[] = {
    {"SAH cost", [](const TreeQuality& q) { return q.sah; }},
    {"EPO", [](const TreeQuality& q) { return q.epo; }},
    {"0.29 SAH + 0.71 EPO", [](const TreeQuality& q) { return q.sah_epo; }},
    {"sibling overlap, mean", [](const TreeQuality& q) { return q.sibling_overlap; }},
    {"empty space, mean", [](const TreeQuality& q) { return q.empty_space; }},
    {"levels", [](const TreeQuality& q) { return static_cast<double>(q.levels); }},
    {"nodes", [](const TreeQuality& q) { return static_cast<double>(q.nodes); }},
    {"expected root visits", [](const TreeQuality& q) { return q.expected_visits; }},
    {"root visits, mean", [](const TreeQuality& q) { return q.visits_mean; }},
    {"root visits, 99th percentile", [](const TreeQuality& q) { return q.visits_p99; }},
    {"root visits, maximum", [](const TreeQuality& q) { return static_cast<double>(q.visits_max); }},
    {"root visits, mean of warp maxima", [](const TreeQuality& q) { return q.warp_ratio * q.visits_mean; }},
    {"root visits, warp maximum / mean", [](const TreeQuality& q) { return q.warp_ratio; }},
    {"root visits per true pair", [](const TreeQuality& q) { return q.tests_per_pair; }},
    {"own visits, mean", [](const TreeQuality& q) { return q.own.mean; }},
    {"own visits, 99th percentile", [](const TreeQuality& q) { return by_query(q, q.own.p99); }},
    {"own visits, maximum", [](const TreeQuality& q) { return by_query(q, static_cast<double>(q.own.max)); }},
    {"own visits, mean of warp maxima",
     [](const TreeQuality& q) { return by_query(q, q.own.warp_ratio * q.own.mean); }},
};

/// Rank correlation of a measure with the query time. `all`: over all rows. `within`: over the trees of one
/// scene (one variant and N, at least three trees), averaged over scenes; only the tree differs there.
struct Score {
  const char* name;
  double own_within = 0, own_all = 0, same_within = 0, same_all = 0;
};

double correlation(const std::vector<const PredictorRow*>& rows, const Measure& measure,
                   double PredictorRow::*time) {
  std::vector<double> x, y;
  for (const PredictorRow* r : rows) {
    const double value = measure.of(r->quality);
    if (std::isnan(value)) continue;
    x.push_back(value);
    y.push_back(r->*time);
  }
  return rank_correlation(x, y);
}

std::vector<Score> scores_of(const std::vector<PredictorRow>& rows) {
  std::vector<const PredictorRow*> all;
  std::map<std::pair<std::string, std::int64_t>, std::vector<const PredictorRow*>> scenes;
  for (const PredictorRow& r : rows) {
    all.push_back(&r);
    scenes[{r.variant, r.quality.bodies}].push_back(&r);
  }
  std::erase_if(scenes, [](const auto& scene) { return scene.second.size() < 3; });
  std::vector<Score> scores;
  for (const Measure& m : measures) {
    const auto within = [&](double PredictorRow::*time) {
      double sum = 0;
      for (const auto& scene : scenes) sum += correlation(scene.second, m, time);
      return scenes.empty() ? 0 : sum / static_cast<double>(scenes.size());
    };
    scores.push_back({m.name, within(&PredictorRow::own_ns), correlation(all, m, &PredictorRow::own_ns),
                      within(&PredictorRow::same_ns), correlation(all, m, &PredictorRow::same_ns)});
  }
  std::ranges::stable_sort(scores, std::greater<>(), &Score::same_within);
  return scores;
}

PredictorRow measure_tree(const SweepPoint& at, int repeats) {
  World world(at.scene, at.run);
  PredictorRow row;
  row.method = at.run.broad_phase;
  row.variant = at.variant;
  row.quality = world.tree().quality();
  if (row.quality.nodes == 0) return row;
  const double ns_a_body = 1e6 / static_cast<double>(row.quality.bodies);
  row.same_ns = ns_a_body * percentiles_of(world.tree().time_queries(repeats)).median;
  for (const BroadPhaseTimes::Stage& stage : world.tree().time_broad_phase(repeats).stages)
    if (stage.name == "pairs") row.own_ns = ns_a_body * percentiles_of(stage.ms).median;
  return row;
}

std::string predictors_json(const BenchMachine& machine, const std::vector<PredictorRow>& rows) {
  Json json{{"suite", "predictors"},
            {"physics_version", physics_version},
            {"executor", machine.executor},
            {"device", machine.device},
            {"plugins", machine.plugins},
            {"blocks", machine.shape.blocks},
            {"threads", machine.shape.threads},
            {"correlations", Json::array()},
            {"rows", Json::array()}};
  for (const Score& s : scores_of(rows))
    json["correlations"].push_back({{"measure", s.name},
                                    {"same_query_within_scenes", s.same_within},
                                    {"same_query_all", s.same_all},
                                    {"own_query_within_scenes", s.own_within},
                                    {"own_query_all", s.own_all}});
  for (const PredictorRow& r : rows) {
    Json row{{"method", r.method},       {"variant", r.variant},       {"bodies", r.quality.bodies},
             {"pairs", r.quality.pairs}, {"same_query_ns", r.same_ns}, {"own_query_ns", r.own_ns}};
    for (const Measure& m : measures) row[m.name] = m.of(r.quality);  // NaN becomes null
    json["rows"].push_back(row);
  }
  return json_text(json);
}

std::string predictors_csv(const std::vector<PredictorRow>& rows) {
  std::string text = "method,variant,bodies,pairs,same_query_ns,own_query_ns";
  for (const Measure& m : measures) text += fmt::format(",\"{}\"", m.name);
  text += '\n';
  for (const PredictorRow& r : rows) {
    text += fmt::format("{},{},{},{},{:.3f},{:.3f}", r.method, r.variant, r.quality.bodies, r.quality.pairs,
                        r.same_ns, r.own_ns);
    for (const Measure& m : measures) {
      const double value = m.of(r.quality);
      text += std::isnan(value) ? "," : fmt::format(",{:.6g}", value);
    }
    text += '\n';
  }
  return text;
}

std::string predictors_text(const BenchMachine& machine, const std::vector<PredictorRow>& rows,
                            bool markdown) {
  std::string text = fmt::format(
      "{}; {} trees. Spearman's rank correlation of each measure with the time of a query; 1: same order.\n"
      "Same: the same traversal of every tree. Own: the method's own traversal and ordering of pairs.\n"
      "Within: mean over scenes of the correlation over the trees of a scene. All: over all trees.\n\n",
      text_of(machine), rows.size());
  text +=
      markdown
          ? "| measure | same query, within | same query, all | own query, within | own query, all |\n"
            "|---|---:|---:|---:|---:|\n"
          : fmt::format("{:<28}{:>12}{:>12}{:>12}{:>12}\n", "", "same,", "same,", "own,", "own,") +
                fmt::format("{:<28}{:>12}{:>12}{:>12}{:>12}\n", "measure", "within", "all", "within", "all");
  for (const Score& s : scores_of(rows))
    text += markdown ? fmt::format("| {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n", s.name, s.same_within,
                                   s.same_all, s.own_within, s.own_all)
                     : fmt::format("{:<28}{:>12.2f}{:>12.2f}{:>12.2f}{:>12.2f}\n", s.name, s.same_within,
                                   s.same_all, s.own_within, s.own_all);
  return text;
}

/// Chart of the common query's time over the best predictor.
Chart predictors_chart(const BenchMachine& machine, const std::vector<PredictorRow>& rows) {
  const Score best = scores_of(rows).front();
  const Measure& measure =
      *std::ranges::find_if(measures, [&](const Measure& m) { return m.name == best.name; });
  Chart chart;
  chart.title = fmt::format(
      "Best predictor of the time of a query: {} (rank correlation {:.2f} within scenes, {:.2f} overall)",
      best.name, best.same_within, best.same_all);
  chart.note = text_of(machine) + "; the same traversal of every tree, median";
  chart.x = {best.name, short_number, true};
  chart.y = {"ns per query", short_number, true};
  for (const PredictorRow& r : rows) {
    if (std::isnan(measure.of(r.quality))) continue;
    auto series = std::ranges::find(chart.series, r.method, &ChartSeries::name);
    if (series == chart.series.end()) {
      chart.series.push_back({r.method, chart_color(chart.series.size()), {}, false});
      series = chart.series.end() - 1;
    }
    series->points.push_back({measure.of(r.quality), r.same_ns});
  }
  return chart;
}

}  // namespace

int bench_predictors(const CommandLine& line) {
  const ResultFiles files(line.options);
  std::vector<std::string> methods = broad_phase_names(line.options.run.executor);
  std::erase(methods, "bvh_recursive");  // same tree as bvh_bottom_up
  std::vector<PredictorRow> rows;
  BenchMachine machine;
  const SweepDefaults defaults{{1'000, 5'000, 20'000, 50'000}, methods, {"paper", "scaled", "equal"}};
  sweep(line, defaults, [&](const SweepPoint& at) {
    if (machine.device.empty()) machine = machine_of(World(at.scene, at.run));
    PredictorRow row = measure_tree(at, static_cast<int>(line.options.bench.repeats));
    if (row.quality.nodes == 0) return;
    rows.push_back(row);
    files.write(predictors_json(machine, rows), predictors_csv(rows), predictors_text(machine, rows, true));
  });
  if (rows.empty())
    throw InputError(
        "bench predictors: no tree to measure; expected a method with a tree and at least one body");
  files.plot(predictors_chart(machine, rows));
  print(line.options.json == "-" ? predictors_json(machine, rows) : predictors_text(machine, rows, false));
  return 0;
}

}  // namespace collidoscope

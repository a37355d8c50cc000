#include "headless/tree_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "headless/reporting/percentiles.h"
#include "headless/reporting/report.h"

namespace collidoscope {
namespace {

std::string depth_histogram(const TreeQuality& q) {
  // One character per level: 0 to 9 relative to the fullest level, '.' for an empty one.
  std::string text;
  const std::int64_t most = *std::max_element(q.leaves.begin(), q.leaves.end());
  for (const std::int64_t leaves : q.leaves)
    text += leaves == 0 ? '.' : static_cast<char>('0' + 9 * leaves / most);
  return text;
}

}  // namespace

void MeasuredTree::take(const BroadPhaseTimes& times) {
  for (const BroadPhaseTimes::Stage& stage : times.stages) {
    const double us = 1000 * percentiles_of(stage.ms).median;
    if (stage.name == "pairs") query_us += us;
    if (stage.name == "keys" || stage.name == "sort" || stage.name == "build") build_us += us;
  }
}

nlohmann::ordered_json json_of(const MeasuredTree& m) {
  using Json = nlohmann::ordered_json;
  const TreeQuality& q = m.quality;
  const auto known = [&](double value) { return q.own.by_query ? Json(value) : Json(nullptr); };
  return {{"method", m.method},
          {"key_bits", m.key_bits > 0 ? Json(m.key_bits) : Json(nullptr)},
          {"nodes", q.nodes},
          {"levels", q.levels},
          {"bytes", q.bytes},
          {"sah", q.sah},
          {"epo", q.epo},
          {"sah_epo", q.sah_epo},
          {"sibling_overlap", q.sibling_overlap},
          {"empty_space", q.empty_space},
          {"leaves_by_level", q.leaves},
          {"own_visits",
           {{"mean", q.own.mean},
            {"p99", known(q.own.p99)},
            {"max", known(static_cast<double>(q.own.max))},
            {"warp_max_over_mean", known(q.own.warp_ratio)}}},
          {"root_visits",
           {{"mean", q.visits_mean},
            {"p99", q.visits_p99},
            {"max", q.visits_max},
            {"warp_max_over_mean", q.warp_ratio},
            {"expected", q.expected_visits},
            {"per_pair", q.tests_per_pair}}},
          {"pairs", q.pairs},
          {"build_median_us", m.build_us},
          {"query_median_us", m.query_us}};
}

std::string text_of(const std::vector<MeasuredTree>& trees) {
  std::string text;
  const auto row = [&](const char* what, auto value) {
    text += fmt::format("  {:<26}", what);
    for (const MeasuredTree& m : trees) text += fmt::format("{:>18}", value(m));
    text += '\n';
  };
  const auto number = [](double value) { return fmt::format("{:.4g}", value); };
  row("", [](const MeasuredTree& m) { return m.method; });
  row("Morton key bits", [](const MeasuredTree& m) { return m.key_bits > 0 ? grouped(m.key_bits) : "-"; });
  row("nodes", [](const MeasuredTree& m) { return grouped(m.quality.nodes); });
  row("levels", [](const MeasuredTree& m) { return grouped(m.quality.levels); });
  row("bytes", [](const MeasuredTree& m) { return m.quality.bytes > 0 ? grouped(m.quality.bytes) : "-"; });
  row("SAH cost", [&](const MeasuredTree& m) { return number(m.quality.sah); });
  row("EPO", [&](const MeasuredTree& m) { return number(m.quality.epo); });
  row("0.29 SAH + 0.71 EPO", [&](const MeasuredTree& m) { return number(m.quality.sah_epo); });
  row("sibling overlap, mean", [&](const MeasuredTree& m) { return number(m.quality.sibling_overlap); });
  row("empty space, mean", [&](const MeasuredTree& m) { return number(m.quality.empty_space); });
  const auto own = [&](double (*value)(const OwnVisits&)) {
    return [&number, value](const MeasuredTree& m) {
      return m.quality.own.by_query ? number(value(m.quality.own)) : "-";
    };
  };
  row("own visits/query: mean",
      [&](const MeasuredTree& m) { return m.quality.own.mean > 0 ? number(m.quality.own.mean) : "-"; });
  row("  99th percentile", own([](const OwnVisits& v) { return v.p99; }));
  row("  maximum", own([](const OwnVisits& v) { return static_cast<double>(v.max); }));
  row("  warp maximum / mean", own([](const OwnVisits& v) { return v.warp_ratio; }));
  row("root visits/query: mean", [&](const MeasuredTree& m) { return number(m.quality.visits_mean); });
  row("  99th percentile", [&](const MeasuredTree& m) { return number(m.quality.visits_p99); });
  row("  maximum", [](const MeasuredTree& m) { return grouped(m.quality.visits_max); });
  row("  warp maximum / mean", [&](const MeasuredTree& m) { return number(m.quality.warp_ratio); });
  row("  expected", [&](const MeasuredTree& m) { return number(m.quality.expected_visits); });
  row("  per overlapping pair", [&](const MeasuredTree& m) { return number(m.quality.tests_per_pair); });
  const auto time = [](double us) { return us > 0 ? fmt::format("{:.1f}", us) : "-"; };
  row("build, median us", [&](const MeasuredTree& m) { return time(m.build_us); });
  row("query, median us", [&](const MeasuredTree& m) { return time(m.query_us); });
  text +=
      "\n  own visits: nodes read by the method's own traversal; for bullet_dbvt, tests of node pairs.\n"
      "  root visits: boxes tested by the same query from the root of each displayed tree.\n"
      "\n  leaves per level, 0 to 9 relative to the fullest level:\n";
  for (const MeasuredTree& m : trees)
    text += fmt::format("  {:<26}{}\n", m.method, depth_histogram(m.quality));
  return text;
}

}  // namespace collidoscope

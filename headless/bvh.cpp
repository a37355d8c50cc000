#include "headless/bvh.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "headless/cli/output_file.h"
#include "headless/cli/progress.h"
#include "headless/cli/standard_output.h"
#include "headless/reporting/percentiles.h"
#include "headless/reporting/report.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/world.h"

namespace collidoscope {
namespace {

using Json = nlohmann::ordered_json;

struct MeasuredTree {
  std::string method;
  int key_bits = 0;  ///< 0: no Morton keys
  TreeQuality quality;
  double build_us = 0, query_us = 0;  ///< medians; the query includes the ordering of its pairs
};

MeasuredTree measure_tree_of(World& world, int repeats) {
  MeasuredTree m;
  m.method = world.options().broad_phase;
  m.key_bits = world.info().key_bits;
  m.quality = world.tree().quality();
  for (const BroadPhaseTimes::Stage& stage : world.tree().time_broad_phase(repeats).stages) {
    const double us = 1000 * percentiles_of(stage.ms).median;
    if (stage.name == "pairs") m.query_us += us;
    if (stage.name == "keys" || stage.name == "sort" || stage.name == "build") m.build_us += us;
  }
  return m;
}

Json json_of(const MeasuredTree& m) {
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

std::string depth_histogram(const TreeQuality& q) {
  // One character per level: 0 to 9 relative to the fullest level, '.' for an empty one.
  std::string text;
  const std::int64_t most = *std::max_element(q.leaves.begin(), q.leaves.end());
  for (const std::int64_t leaves : q.leaves)
    text += leaves == 0 ? '.' : static_cast<char>('0' + 9 * leaves / most);
  return text;
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
  row("bytes", [](const MeasuredTree& m) { return grouped(m.quality.bytes); });
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
  row("own visits/query: mean", [&](const MeasuredTree& m) { return number(m.quality.own.mean); });
  row("  99th percentile", own([](const OwnVisits& v) { return v.p99; }));
  row("  maximum", own([](const OwnVisits& v) { return static_cast<double>(v.max); }));
  row("  warp maximum / mean", own([](const OwnVisits& v) { return v.warp_ratio; }));
  row("root visits/query: mean", [&](const MeasuredTree& m) { return number(m.quality.visits_mean); });
  row("  99th percentile", [&](const MeasuredTree& m) { return number(m.quality.visits_p99); });
  row("  maximum", [](const MeasuredTree& m) { return grouped(m.quality.visits_max); });
  row("  warp maximum / mean", [&](const MeasuredTree& m) { return number(m.quality.warp_ratio); });
  row("  expected", [&](const MeasuredTree& m) { return number(m.quality.expected_visits); });
  row("  per overlapping pair", [&](const MeasuredTree& m) { return number(m.quality.tests_per_pair); });
  row("build, median us", [](const MeasuredTree& m) { return fmt::format("{:.1f}", m.build_us); });
  row("query, median us", [](const MeasuredTree& m) { return fmt::format("{:.1f}", m.query_us); });
  text +=
      "\n  own visits: nodes read by the method's own traversal; for bullet_dbvt, tests of node pairs.\n"
      "  root visits: boxes tested by the same query from the root of each displayed tree.\n"
      "\n  leaves per level, 0 to 9 relative to the fullest level:\n";
  for (const MeasuredTree& m : trees)
    text += fmt::format("  {:<26}{}\n", m.method, depth_histogram(m.quality));
  return text;
}

}  // namespace

int bvh_command(const CommandLine& line) {
  const Options& options = line.options;
  const Scene scene = load_scene(line);
  std::optional<OutputFile> file;
  if (!options.json.empty() && options.json != "-") file.emplace("--json", options.json);
  const std::vector<std::string> methods =
      options.bench.methods.empty() ? broad_phase_names(options.run.executor) : options.bench.methods;

  std::vector<MeasuredTree> trees;
  std::optional<World> first;  // makes the steps; the other worlds start from its state
  std::string device;
  std::size_t bodies = 0;
  Progress progress("methods", std::ssize(methods));
  for (std::int64_t k = 0; k < std::ssize(methods); ++k) {
    RunOptions run = options.run;
    run.broad_phase = methods[static_cast<std::size_t>(k)];
    World world(scene, run);
    bodies = world.initial().size();
    if (world.tree().nodes() > 0) {
      if (!first) {
        first.emplace(scene, run);
        first->step(static_cast<int>(options.steps_or(0)));
      }
      world.restore(*first);
      trees.push_back(measure_tree_of(world, static_cast<int>(options.bench.repeats)));
      device = world.info().device_name;
    }
    progress.update(k + 1);
  }
  if (trees.empty() && bodies == 0)
    throw InputError(scene.name + ": the scene has no bodies; expected at least one body");
  if (trees.empty())
    throw InputError(fmt::format("{}: no tree to measure with {}; expected a method with a tree", scene.name,
                                 fmt::join(methods, ", ")));
  Json json{
      {"scene", scene.name},     {"physics_version", physics_version}, {"device", device},
      {"state", first->steps()}, {"bodies", trees[0].quality.bodies},  {"pairs", trees[0].quality.pairs},
      {"trees", Json::array()}};
  for (const MeasuredTree& m : trees) json["trees"].push_back(json_of(m));
  if (file) {
    file->write(json_text(json));
    file->commit();
  }
  if (options.json == "-")
    print(json_text(json));
  else
    print(fmt::format("{}: {} bodies, {} pairs of boxes, state {}, on {}\n\n{}", scene.name,
                      grouped(trees[0].quality.bodies), grouped(trees[0].quality.pairs), first->steps(),
                      device, text_of(trees)));
  return 0;
}

}  // namespace collidoscope

#include "headless/bench/broad_phases.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "headless/bench/cubql_baseline.h"
#include "headless/bench/method_row.h"
#include "headless/cli/standard_output.h"
#include "headless/reporting/report.h"
#include "headless/reporting/result_files.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/dynamics/bounds.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/scene/crowded_scenes.h"
#include "sim_cuda/scene/initial_bodies.h"
#include "sim_cuda/world.h"

namespace collidoscope {
namespace {

using Json = nlohmann::ordered_json;

std::string broad_phases_json(const BenchMachine& machine, const std::vector<MethodRow>& rows) {
  Json json{{"suite", "broad-phases"},          {"physics_version", physics_version},
            {"executor", machine.executor},     {"device", machine.device},
            {"plugins", machine.plugins},       {"blocks", machine.shape.blocks},
            {"threads", machine.shape.threads}, {"rows", Json::array()}};
  for (const MethodRow& row : rows) json["rows"].push_back(json_of(row));
  return json_text(json);
}

std::string key_bits_text(const MethodRow& r) { return r.key_bits > 0 ? fmt::to_string(r.key_bits) : "-"; }
std::string visits_text(const MethodRow& r) { return r.visits > 0 ? fmt::format("{:.1f}", r.visits) : "-"; }

std::string broad_phases_markdown(const BenchMachine& machine, const std::vector<MethodRow>& rows) {
  std::string text = fmt::format(
      "{}; time in µs from positions to the ordered list of pairs, median (5th to 95th percentile).\n\n"
      "| N | variant | method | key bits | µs | pairs | own visits per query | launches | bytes per body | "
      "stages, µs (timed separately; *: partly library launch) |\n"
      "|---:|---|---|---:|---:|---:|---:|---:|---:|---|\n",
      text_of(machine));
  for (const MethodRow& r : rows)
    text +=
        fmt::format("| {} | `{}` | `{}` | {} | {:.1f} ({:.1f} to {:.1f}) | {} | {} | {} | {:.0f} | {} |\n",
                    grouped(r.bodies), r.variant, r.method, key_bits_text(r), r.whole.median, r.whole.p5,
                    r.whole.p95, grouped(r.pairs), visits_text(r), r.launches,
                    static_cast<double>(r.bytes) / static_cast<double>(std::max<std::int64_t>(r.bodies, 1)),
                    stages_text(r));
  return text;
}

/// Measures cuBQL on the scene of `ours`. Throws MachineError if it finds different pairs.
MethodRow measure_cubql(const Scene& scene, const MethodRow& ours) {
  const InitialBodies bodies = initial_bodies(scene);
  std::vector<Vector3f> position(bodies.size());
  std::vector<float> radius(bodies.size());
  std::vector<Aabb> boxes(bodies.size());
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    position[k] = bodies.position[k].cast<float>();
    radius[k] = static_cast<float>(bodies.radius[k]);
  }
  const BodyBounds<float> bounds{position.data(), radius.data(), boxes.data()};
  for (std::size_t k = 0; k < bodies.size(); ++k) bounds(static_cast<int>(k));
  const BaselineTimes times = time_cubql(boxes, ours.repeats);
  if (times.pairs != ours.pairs)
    throw MachineError(fmt::format("cuBQL: found {} pairs of {} bodies, expected {}", times.pairs,
                                   bodies.size(), ours.pairs));
  MethodRow row = ours;
  row.method = "cuBQL, unordered";
  row.bytes = times.bytes;
  row.launches = 0;
  row.stages.clear();
  std::vector<float> us(times.ms);
  for (float& time : us) time *= 1000;
  row.whole = percentiles_of(us);
  return row;
}

void print_row(const MethodRow& r) {
  print(fmt::format("{:>12} {:<11}{:<20}{:>4}{:>12.1f}{:>12.1f}{:>12.1f}{:>14}{:>9}{:>5}  {}\n",
                    grouped(r.bodies), r.variant, r.method, key_bits_text(r), r.whole.median, r.whole.p5,
                    r.whole.p95, grouped(r.pairs), visits_text(r), r.launches, stages_text(r)));
  flush_stdout();
}

}  // namespace

int bench_broad_phases(const CommandLine& line) {
  const ResultFiles files(line.options);
  const std::vector<std::string> methods = broad_phase_names(line.options.run.executor);
  const bool table = line.options.json != "-";
  std::vector<MethodRow> rows;
  BenchMachine machine;
  SweepDefaults defaults{{1'000, 10'000, 100'000}, methods, {own_variant(load_scene(line))}};
  const auto crowded = crowded_scene_names();
  defaults.variants.insert(defaults.variants.end(), crowded.begin(), crowded.end());
  sweep(line, defaults, [&](const SweepPoint& at) {
    if (rows.empty()) {
      machine = machine_of(World(at.scene, at.run));
      if (table)
        print(fmt::format(
            "{}\nkeys: bits per Morton key. visits: mean number of nodes that a query of the method reads.\n"
            "{:>12} {:<11}{:<20}{:>4}{:>12}{:>12}{:>12}{:>14}{:>9}{:>5}  stages, µs (timed separately)\n",
            text_of(machine), "N", "variant", "method", "keys", "median µs", "p5", "p95", "pairs", "visits",
            "runs"));
    }
    const std::size_t known = rows.size();
    const auto add = [&](MethodRow row) { rows.push_back(std::move(row)); };
    add(measure_method(at, static_cast<int>(line.options.bench.repeats)));
    if (has_cubql() && machine.executor == "cuda" && at.run.broad_phase == methods.front())
      add(measure_cubql(at.scene, rows.back()));
    files.write(broad_phases_json(machine, rows), csv_of(rows), broad_phases_markdown(machine, rows));
    for (std::size_t k = known; table && k < rows.size(); ++k) print_row(rows[k]);
  });
  files.plot(
      chart_of_methods("Broad phases: time from positions to the ordered list of pairs", machine, rows));
  if (!table) print(broad_phases_json(machine, rows));
  return 0;
}

}  // namespace collidoscope

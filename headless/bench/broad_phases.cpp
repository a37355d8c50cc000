#include "headless/bench/broad_phases.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "headless/bench/result_files.h"
#include "headless/bench/spread.h"
#include "headless/progress.h"
#include "headless/report.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/world.h"

namespace collidoscope {
namespace {

using Json = nlohmann::ordered_json;

/// What tests nearly every body against every other is left out beyond this: 5e9 tests, seconds on a CPU.
constexpr std::int64_t most_for_all_pairs = 100'000;
bool tests_all_pairs(const std::string& method) {
  return method.starts_with("brute_force") || method == "bvh_input_order";
}

struct Row {
  std::string method, variant;
  std::int64_t bodies = 0, pairs = 0, bytes = 0;
  int launches = 0, repeats = 0;
  Spread whole;  ///< us
  struct Stage {
    std::string name;
    double median_us;
    int launches;
    bool own_shape;
  };
  std::vector<Stage> stages;
  /// What any method must move: positions and radii read, boxes written and read, pairs written.
  std::int64_t floor_bytes() const { return bodies * (16 + 2 * 24) + pairs * 4; }
};

Row measure(const Scene& scene, const RunOptions& options, int repeats) {
  World world(scene, options);
  const BroadPhaseTimes times = world.time_broad_phase(repeats);
  Row row;
  row.method = options.broad_phase;
  row.variant = name_of(variant_names, scene.generators[0].variant);
  row.bodies = static_cast<std::int64_t>(world.initial().size());
  row.pairs = world.measure().pairs;
  row.bytes = world.broad_phase_bytes();
  row.repeats = repeats;
  const auto in_us = [](std::vector<float> samples) {
    for (float& ms : samples) ms *= 1000;
    return spread_of(samples);
  };
  row.whole = in_us(times.whole);
  for (const BroadPhaseTimes::Stage& stage : times.stages) {
    row.stages.push_back({stage.name, in_us(stage.ms).median, stage.launches, stage.own_shape});
    row.launches += stage.launches;
  }
  return row;
}

Json json_of(const Row& row) {
  Json json{{"method", row.method},     {"variant", row.variant},  {"bodies", row.bodies},
            {"pairs", row.pairs},       {"bytes", row.bytes},      {"floor_bytes", row.floor_bytes()},
            {"launches", row.launches}, {"repeats", row.repeats},  {"median_us", row.whole.median},
            {"p5_us", row.whole.p5},    {"p95_us", row.whole.p95}, {"stages", Json::array()}};
  for (const Row::Stage& stage : row.stages)
    json["stages"].push_back({{"name", stage.name},
                              {"median_us", stage.median_us},
                              {"launches", stage.launches},
                              {"own_shape", stage.own_shape}});
  return json;
}

struct Machine {
  std::string executor, device;
  LaunchShape shape;
};

std::string results_json(const Machine& machine, const std::vector<Row>& rows) {
  Json json{{"suite", "broad-phases"},        {"executor", machine.executor},     {"device", machine.device},
            {"blocks", machine.shape.blocks}, {"threads", machine.shape.threads}, {"rows", Json::array()}};
  for (const Row& row : rows) json["rows"].push_back(json_of(row));
  return json_text(json);
}

std::string results_csv(const std::vector<Row>& rows) {
  std::string text =
      "method,variant,bodies,pairs,bytes,floor_bytes,launches,repeats,median_us,p5_us,p95_us\n";
  for (const Row& r : rows)
    text +=
        fmt::format("{},{},{},{},{},{},{},{},{:.2f},{:.2f},{:.2f}\n", r.method, r.variant, r.bodies, r.pairs,
                    r.bytes, r.floor_bytes(), r.launches, r.repeats, r.whole.median, r.whole.p5, r.whole.p95);
  return text;
}

std::string stages_text(const Row& row) {
  std::vector<std::string> parts;
  for (const Row::Stage& stage : row.stages)
    parts.push_back(fmt::format("{}{} {:.1f}", stage.name, stage.own_shape ? "*" : "", stage.median_us));
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string results_markdown(const Machine& machine, const std::vector<Row>& rows) {
  std::string text = fmt::format(
      "{}, B {}, T {}; microseconds from positions to the ordered list of pairs, median (5th to 95th "
      "percentile).\n\n"
      "| N | variant | method | µs | pairs | launches | bytes a body | stages, µs (timed apart; * in part "
      "own shape) |\n"
      "|---:|---|---|---:|---:|---:|---:|---|\n",
      machine.device, machine.shape.blocks ? std::to_string(machine.shape.blocks) : "auto",
      machine.shape.threads ? std::to_string(machine.shape.threads) : "auto");
  for (const Row& r : rows)
    text += fmt::format(
        "| {} | `{}` | `{}` | {:.1f} ({:.1f} to {:.1f}) | {} | {} | {:.0f} | {} |\n", grouped(r.bodies),
        r.variant, r.method, r.whole.median, r.whole.p5, r.whole.p95, grouped(r.pairs), r.launches,
        static_cast<double>(r.bytes) / static_cast<double>(std::max<std::int64_t>(r.bodies, 1)),
        stages_text(r));
  return text;
}

void print_row(const Row& r) {
  fmt::print("{:>12} {:<8}{:<20}{:>12.1f}{:>12.1f}{:>12.1f}{:>14}{:>5}  {}\n", grouped(r.bodies), r.variant,
             r.method, r.whole.median, r.whole.p5, r.whole.p95, grouped(r.pairs), r.launches, stages_text(r));
  std::fflush(stdout);
}

}  // namespace

int bench_broad_phases(const CommandLine& line) {
  const Options& options = line.options;
  Scene scene = load_scene(line);
  if (scene.generators.size() != 1)
    throw InputError(
        scene.name +
        ": bench broad-phases varies the number of bodies: a scene with one generator is needed");
  const BenchRequest& request = options.bench;
  const std::vector<std::string> methods = request.methods.empty() ? broad_phase_names() : request.methods;
  const std::vector<Variant> variants =
      request.variants.empty() ? std::vector{scene.generators[0].variant} : request.variants;
  std::vector<std::int64_t> sizes = request.sizes;
  if (sizes.empty()) sizes = {1'000, 10'000, 100'000};

  const ResultFiles files(options);

  const bool table = options.json != "-";
  std::vector<Row> rows;
  Machine machine;
  const std::int64_t total = std::ssize(sizes) * std::ssize(variants) * std::ssize(methods);
  std::int64_t done = 0;
  Progress progress("rows", total);
  for (const std::int64_t bodies : sizes)
    for (const Variant variant : variants)
      for (const std::string& method : methods) {
        progress.update(done++);
        if (tests_all_pairs(method) && bodies > most_for_all_pairs) continue;
        scene.generators[0].count = bodies;
        scene.generators[0].variant = variant;
        RunOptions run = options.run;
        run.broad_phase = method;
        if (rows.empty()) {
          const World world(scene, run);
          machine = {world.on_gpu() ? "cuda" : "cpu", world.device_name(), world.launch_shape()};
          if (table)
            fmt::print("{}\n{:>12} {:<8}{:<20}{:>12}{:>12}{:>12}{:>14}{:>5}  stages, µs (timed apart)\n",
                       machine.device, "N", "variant", "method", "median µs", "p5", "p95", "pairs", "runs");
        }
        rows.push_back(measure(scene, run, static_cast<int>(request.repeats)));
        if (table) print_row(rows.back());
        files.write(results_json(machine, rows), results_csv(rows), results_markdown(machine, rows));
      }
  if (!table) fmt::print("{}", results_json(machine, rows));
  return 0;
}

}  // namespace collidoscope

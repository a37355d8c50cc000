#include "headless/bench/method_row.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "headless/cli/progress.h"
#include "headless/pictures/chart_picture.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/scene/crowded_scenes.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/world.h"

namespace collidoscope {
namespace {

/// Body limit for methods that test nearly all pairs: 5e9 tests, seconds on a CPU.
constexpr std::int64_t most_for_all_pairs = 100'000;
bool tests_all_pairs(const std::string& method, const std::string& variant) {
  const bool mixed_sizes = variant == "mixed" || variant == "log_normal";
  return method.starts_with("brute_force") || method == "bvh_input_order" ||
         (method == "uniform_grid" && mixed_sizes);
}

}  // namespace

MethodRow measure_method(const SweepPoint& at, int repeats) {
  World world(at.scene, at.run);
  const BroadPhaseTimes times = world.tree().time_broad_phase(repeats);
  MethodRow row;
  row.method = at.run.broad_phase;
  row.variant = at.variant;
  row.bodies = static_cast<std::int64_t>(world.initial().size());
  row.pairs = world.measure().pairs;
  row.bytes = world.info().broad_phase_bytes;
  row.repeats = repeats;
  row.key_bits = world.info().key_bits;
  row.visits = world.tree().own_visits();
  const auto in_us = [](std::vector<float> samples) {
    for (float& ms : samples) ms *= 1000;
    return percentiles_of(samples);
  };
  row.whole = in_us(times.whole);
  for (const BroadPhaseTimes::Stage& stage : times.stages) {
    row.stages.push_back({stage.name, in_us(stage.ms).median, stage.launches, stage.library_launch});
    row.launches += stage.launches;
  }
  return row;
}

nlohmann::ordered_json json_of(const MethodRow& row) {
  nlohmann::ordered_json json{
      {"method", row.method},     {"variant", row.variant},  {"bodies", row.bodies},
      {"pairs", row.pairs},       {"bytes", row.bytes},      {"floor_bytes", row.floor_bytes()},
      {"launches", row.launches}, {"repeats", row.repeats},  {"median_us", row.whole.median},
      {"p5_us", row.whole.p5},    {"p95_us", row.whole.p95}, {"stages", nlohmann::ordered_json::array()}};
  json["key_bits"] = row.key_bits > 0 ? nlohmann::ordered_json(row.key_bits) : nullptr;
  json["own_visits_mean"] = row.visits > 0 ? nlohmann::ordered_json(row.visits) : nullptr;
  for (const MethodRow::Stage& stage : row.stages)
    json["stages"].push_back({{"name", stage.name},
                              {"median_us", stage.median_us},
                              {"launches", stage.launches},
                              {"library_launch", stage.library_launch}});
  return json;
}

std::string csv_of(const std::vector<MethodRow>& rows) {
  std::string text =
      "method,variant,bodies,pairs,bytes,floor_bytes,launches,repeats,median_us,p5_us,p95_us,key_bits,"
      "own_visits_mean\n";
  for (const MethodRow& r : rows)
    text += fmt::format("{},{},{},{},{},{},{},{},{:.2f},{:.2f},{:.2f},{},{}\n", r.method, r.variant, r.bodies,
                        r.pairs, r.bytes, r.floor_bytes(), r.launches, r.repeats, r.whole.median, r.whole.p5,
                        r.whole.p95, r.key_bits > 0 ? fmt::to_string(r.key_bits) : "",
                        r.visits > 0 ? fmt::format("{:.2f}", r.visits) : "");
  return text;
}

std::string stages_text(const MethodRow& row) {
  std::vector<std::string> parts;
  for (const MethodRow::Stage& stage : row.stages)
    parts.push_back(fmt::format("{}{} {:.1f}", stage.name, stage.library_launch ? "*" : "", stage.median_us));
  return fmt::format("{}", fmt::join(parts, ", "));
}

BenchMachine machine_of(const World& world) {
  const WorldInfo info = world.info();
  return {info.on_gpu ? "cuda" : "cpu", info.device_name, world.launch_shape(),
          plugin_notes(world.options().check_pairs)};
}

std::string text_of(const BenchMachine& machine) {
  const auto number = [](int n) { return n > 0 ? std::to_string(n) : "auto"; };
  std::string text = fmt::format("{}, B {}, T {}", machine.device, number(machine.shape.blocks),
                                 number(machine.shape.threads));
  for (const std::string& plugin : machine.plugins) text += "; " + plugin;
  return text;
}

Chart chart_of_methods(const std::string& title, const BenchMachine& machine,
                       const std::vector<MethodRow>& rows) {
  Chart chart;
  chart.title = title;
  chart.note = text_of(machine) + "; median, 5th to 95th percentile";
  chart.x = {"bodies", short_number, true};
  chart.y = {"µs", short_number, true};
  const bool variants =
      std::ranges::any_of(rows, [&](const MethodRow& r) { return r.variant != rows[0].variant; });
  for (const MethodRow& r : rows) {
    const std::string name = variants ? r.method + ", " + r.variant : r.method;
    auto series = std::ranges::find(chart.series, name, &ChartSeries::name);
    if (series == chart.series.end()) {
      chart.series.push_back({name, chart_color(chart.series.size()), {}});
      series = chart.series.end() - 1;
    }
    ChartPoint point{static_cast<double>(r.bodies), r.whole.median};
    point.y_low = r.whole.p5;
    point.y_high = r.whole.p95;
    series->points.push_back(point);
  }
  return chart;
}

std::string own_variant(const Scene& scene) {
  return scene.generators.size() == 1 ? std::string(name_of(variant_names, scene.generators[0].variant)) : "";
}

void sweep(const CommandLine& line, const SweepDefaults& defaults,
           const std::function<void(const SweepPoint&)>& visit) {
  Scene scene = load_scene(line);
  if (scene.generators.size() != 1)
    throw InputError(scene.name + ": bench " + line.suite +
                     " varies the number of bodies; expected a scene with exactly one generator");
  const BenchRequest& request = line.options.bench;
  const auto& methods = request.methods.empty() ? defaults.methods : request.methods;
  const auto& sizes = request.sizes.empty() ? defaults.sizes : request.sizes;
  std::vector<std::string> variants = request.variants.empty() ? defaults.variants : request.variants;
  if (variants.empty()) variants = {own_variant(scene)};

  Progress progress("rows", std::ssize(sizes) * std::ssize(variants) * std::ssize(methods));
  std::int64_t done = 0;
  for (const std::int64_t bodies : sizes)
    for (const std::string& variant : variants) {
      SweepPoint point{scene, variant, line.options.run};
      BoxCollider& generator = point.scene.generators[0];
      if (const auto known = value_of(variant_names, variant)) {
        generator.count = bodies;
        generator.variant = *known;
      } else {
        point.scene = crowded_scene(variant, bodies, generator.seed, scene);
      }
      for (const std::string& method : methods) {
        progress.update(done++);
        if (tests_all_pairs(method, variant) && bodies > most_for_all_pairs) continue;
        point.run.broad_phase = method;
        visit(point);
      }
    }
}

}  // namespace collidoscope

#include "headless/bench/effects.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "headless/cli/progress.h"
#include "headless/cli/standard_output.h"
#include "headless/reporting/percentiles.h"
#include "headless/reporting/percentiles_json.h"
#include "headless/reporting/report.h"
#include "headless/reporting/result_files.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/tuning/steps_in_turns.h"

namespace collidoscope {
namespace {

using Json = nlohmann::ordered_json;
constexpr int effect_turn_steps = 4;

/// Scene modifications that make an effect required.
struct EffectCase {
  std::string_view effect;
  void (*ground)(Scene&);    ///< applied in all three runs
  void (*call_for)(Scene&);  ///< makes the effect required; null: `ground` already does
  bool decides = true;       ///< true: the effect changes the state
};

void nothing(Scene&) {}
void spin(Scene& scene) { scene.bodies[0].angular_velocity = Vector3d(0, 0, 1); }
void add_friction(Scene& scene) {
  spin(scene);
  scene.materials[0].friction = 0.5;
}

constexpr EffectCase effect_cases[] = {
    {"gravity",
     [](Scene& s) {
       s.generators[0].speed_max = 5;
       s.physics.restitution_threshold = 1;
       s.physics.gravity.setZero();
     },
     [](Scene& s) { s.physics.gravity = Vector3d(0, 0, -9.81); }},
    {"attractor", nothing,
     [](Scene& s) {
       s.physics.attractors = {Attractor{Vector3d(50, 50, 50), 1e4, 5}};
     }},
    {"drag", nothing, [](Scene& s) { s.physics.drag.density = 1.2; }},
    {"rotation", nothing, spin},
    {"friction", spin, add_friction},
    {"rolling_resistance", add_friction, [](Scene& s) { s.materials[0].rolling_resistance = 0.02; }},
    {"joints", nothing,
     [](Scene& s) {
       for (int k = 1; k < std::min<std::int64_t>(200, s.generators[0].count); k += 2) {
         Joint rod;
         rod.a = k;
         rod.b = k + 1;
         s.joints.push_back(rod);
       }
     }},
    {"continuous_collision", [](Scene& s) { s.generators[0].speed_max = 300; }, nullptr},
    {"sleeping", nothing,
     [](Scene& s) {
       s.physics.sleep = Sleep{2, 0.1};
     }},
    {"guards", nothing, [](Scene& s) { s.physics.guards = ValidationSettings{}; }, false},
};

struct Launched {
  std::string stage;
  int launches;
  friend bool operator==(const Launched&, const Launched&) = default;
};

/// Launches, buffers and state hash of a run.
struct Footprint {
  std::vector<Launched> launches;
  std::map<std::string, std::int64_t> buffers;
  std::uint64_t hash = 0;

  int launch_count() const {
    int count = 0;
    for (const Launched& each : launches) count += each.launches;
    return count;
  }
  std::int64_t bytes() const {
    std::int64_t sum = 0;
    for (const auto& [name, bytes] : buffers) sum += bytes;
    return sum;
  }
};

Footprint footprint_of(World& world) {
  Footprint print;
  for (const StageTime& stage : world.times().stages) print.launches.push_back({stage.name, stage.launches});
  print.buffers = world.buffers();
  print.hash = world.state_hash();
  return print;
}

struct EffectRow {
  std::string effect;
  Footprint without, off, on;
  Percentiles ms, off_ratio, on_ratio;      ///< ms per step without the effect; ratios to it in the same turn
  RatioEstimate off_estimate, on_estimate;  ///< medians of the ratios, with their confidence intervals
  bool decides = true;

  bool off_adds_nothing() const {
    return off.launches == without.launches && off.buffers == without.buffers && off.hash == without.hash;
  }
  /// An effect that does not change the state must give the same hash.
  bool on_matches_hash_rule() const { return decides || on.hash == without.hash; }
  bool on_has_effect() const {
    const bool seen = decides ? on.hash != without.hash : on.launches != without.launches;
    return seen && on_matches_hash_rule();
  }
};

Percentiles percentiles_of_ms(const std::vector<double>& samples) {
  return percentiles_of(std::vector<float>(samples.begin(), samples.end()));
}

Scene base_of(const CommandLine& line) {
  Scene scene = load_scene(line);
  Effects gravity;
  gravity.gravity = true;
  if (scene.generators.size() != 1 || World(scene, line.options.run).effects() != gravity)
    throw InputError(scene.name +
                     ": bench effects expects a scene with one generator that needs only gravity, such as "
                     "box_collider_scaled");
  scene.physics.substeps = substeps_in_effect(scene.physics);  // constant, although joints might require more
  Body body;                                                   // a body that can be given a spin
  body.position = World(scene, line.options.run).initial().box.value_or(Box{}).max * 0.5;
  scene.bodies.push_back(body);
  return scene;
}

EffectRow measure_effect(const EffectCase& effect_case, const Scene& base, const RunOptions& options,
                         std::int64_t turns, const std::function<void()>& turned) {
  Scene without = base;
  effect_case.ground(without);
  Scene on = without;
  if (effect_case.call_for != nullptr) effect_case.call_for(on);
  Scene off = on;
  World with(on, options);
  Effects effects = with.effects();
  for (const EffectName& each : effect_names)
    if (each.name == effect_case.effect) effects.*each.flag = false;
  off.physics.effects = effects;
  if (effect_case.call_for == nullptr) without = off;
  World first(without, options), second(off, options);
  StepsInTurns in_turns({&second, &first, &with}, effect_turn_steps);
  std::vector<double> first_ms, second_ms, with_ms;
  for (std::int64_t turn = 0; turn < turns; ++turn) {
    const std::vector<double> ms = in_turns.turn();
    second_ms.push_back(ms[0]);
    first_ms.push_back(ms[1]);
    with_ms.push_back(ms[2]);
    turned();
  }
  const std::vector<double> off_ratios = ratios_of(second_ms, first_ms),
                            on_ratios = ratios_of(with_ms, first_ms);
  return {std::string(effect_case.effect),
          footprint_of(first),
          footprint_of(second),
          footprint_of(with),
          percentiles_of_ms(first_ms),
          percentiles_of_ms(off_ratios),
          percentiles_of_ms(on_ratios),
          estimate_ratio(off_ratios),
          estimate_ratio(on_ratios),
          effect_case.decides};
}

Json footprint_json(const Footprint& print) {
  Json launches = Json::object();
  for (const Launched& each : print.launches) launches[each.stage] = each.launches;
  return {{"launches", launches},
          {"buffers", print.buffers},
          {"allocated_bytes", print.bytes()},
          {"state_hash", fmt::format("{:016x}", print.hash)}};
}

struct EffectsSetting {
  std::string scene, device, solver;
  std::int64_t bodies, steps;
};

std::string effects_json(const EffectsSetting& setting, const std::vector<EffectRow>& rows) {
  Json json{{"suite", "effects"},       {"physics_version", physics_version},
            {"scene", setting.scene},   {"device", setting.device},
            {"solver", setting.solver}, {"bodies", setting.bodies},
            {"steps", setting.steps},   {"effects", Json::array()}};
  for (const EffectRow& r : rows) {
    Json one{{"effect", r.effect},
             {"off_costs_nothing", r.off_adds_nothing()},
             {"on_is_seen", r.on_has_effect()},
             {"step_ms", percentiles_json(r.ms)},
             {"off_ratio", percentiles_json(r.off_ratio)},
             {"on_ratio", percentiles_json(r.on_ratio)},
             {"off_estimate", estimate_json(r.off_estimate)},
             {"on_estimate", estimate_json(r.on_estimate)},
             {"without", footprint_json(r.without)},
             {"off", footprint_json(r.off)},
             {"on", footprint_json(r.on)}};
    json["effects"].push_back(std::move(one));
  }
  return json_text(json);
}

/// Cells of a row, for the terminal table and for Markdown.
std::vector<std::string> cells_of(const EffectRow& r) {
  const auto ratio = [](const RatioEstimate& e) {
    return std::isfinite(e.high) ? fmt::format("{:.3f} ({:.3f} to {:.3f})", e.ratio, e.low, e.high)
                                 : fmt::format("{:.3f} (too few turns)", e.ratio);
  };
  std::vector<std::string> cells{
      r.effect,
      r.off_adds_nothing() ? "same" : "DIFFERENT",
      fmt::format("{:.2f}", r.ms.median),
      ratio(r.off_estimate),
      ratio(r.on_estimate),
      fmt::format("{:+}", r.on.launch_count() - r.without.launch_count()),
      fmt::format("{:+.1f}",
                  static_cast<double>(r.on.bytes() - r.without.bytes()) / static_cast<double>(1 << 10)),
      r.decides ? (r.on.hash != r.without.hash ? "changed" : "UNCHANGED")
                : (r.on_matches_hash_rule() ? "unchanged" : "CHANGED")};
  return cells;
}
const std::vector<std::string> heads{"effect",
                                     "off: launches, buffers, hash",
                                     "step, ms",
                                     "off, ratio (95 % interval)",
                                     "on, ratio (95 % interval)",
                                     "on: launches",
                                     "on: KiB",
                                     "on: hash"};

std::string effects_markdown(const std::vector<EffectRow>& rows) {
  std::string text = fmt::format("| {} |\n|---|---|---:|---:|---:|---:|---:|---|\n", fmt::join(heads, " | "));
  for (const EffectRow& r : rows) {
    std::vector<std::string> cells = cells_of(r);
    cells[0] = "`" + cells[0] + "`";
    text += fmt::format("| {} |\n", fmt::join(cells, " | "));
  }
  return text;
}

std::string effects_csv(const std::vector<EffectRow>& rows) {
  std::string text =
      "effect,off_costs_nothing,on_is_seen,step_ms,off_ratio,off_ratio_p5,off_ratio_p95,off_ratio_low,"
      "off_ratio_high,on_ratio,on_ratio_p5,on_ratio_p95,on_ratio_low,on_ratio_high,launches_without,launches_"
      "off,launches_on,bytes_without,bytes_off,bytes_on\n";
  for (const EffectRow& r : rows) {
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", r.effect,
                        r.off_adds_nothing(), r.on_has_effect(), r.ms.median, r.off_ratio.median,
                        r.off_ratio.p5, r.off_ratio.p95, r.off_estimate.low, r.off_estimate.high,
                        r.on_ratio.median, r.on_ratio.p5, r.on_ratio.p95, r.on_estimate.low,
                        r.on_estimate.high, r.without.launch_count(), r.off.launch_count(),
                        r.on.launch_count(), r.without.bytes(), r.off.bytes(), r.on.bytes());
  }
  return text;
}

std::string effects_text(const EffectsSetting& setting, const std::vector<EffectRow>& rows) {
  std::string text = fmt::format("{}, N = {}, {}, {} steps on {}\n\n", setting.scene, grouped(setting.bodies),
                                 setting.solver, setting.steps, setting.device);
  std::vector<std::size_t> widths;
  std::vector<std::vector<std::string>> table{heads};
  for (const EffectRow& r : rows) table.push_back(cells_of(r));
  for (std::size_t k = 0; k < heads.size(); ++k) {
    widths.push_back(0);
    for (const auto& cells : table) widths.back() = std::max(widths.back(), cells[k].size());
  }
  for (const auto& cells : table) {
    for (std::size_t k = 0; k < cells.size(); ++k) text += fmt::format("{:<{}}  ", cells[k], widths[k]);
    text.erase(text.find_last_not_of(' ') + 1);
    text += "\n";
  }
  return text;
}

}  // namespace

int bench_effects(const CommandLine& line) {
  const ResultFiles files(line.options);
  const Scene base = base_of(line);
  const std::int64_t turns = line.options.bench.repeats;
  World probe(base, line.options.run);
  const EffectsSetting setting{base.name, probe.info().device_name,
                               std::string(name_of(solver_names, base.physics.solver)),
                               static_cast<std::int64_t>(probe.initial().size()), turns * effect_turn_steps};
  std::vector<EffectRow> rows;
  {
    Progress progress("turns", turns * static_cast<std::int64_t>(std::size(effect_cases)));
    std::int64_t done = 0;
    for (const EffectCase& effect_case : effect_cases) {
      rows.push_back(
          measure_effect(effect_case, base, line.options.run, turns, [&] { progress.update(++done); }));
      files.write(effects_json(setting, rows), effects_csv(rows), effects_markdown(rows));
    }
  }
  print(line.options.json == "-" ? effects_json(setting, rows) : effects_text(setting, rows));
  for (const EffectRow& row : rows)
    if (!row.off_adds_nothing() || !row.on_has_effect()) return 1;
  return 0;
}

}  // namespace collidoscope

#include "headless/bench/solvers.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "headless/bench/bullet_baseline.h"
#include "headless/cli/progress.h"
#include "headless/cli/standard_output.h"
#include "headless/reporting/percentiles.h"
#include "headless/reporting/percentiles_json.h"
#include "headless/reporting/report.h"
#include "headless/reporting/result_files.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/run/run_state.h"
#include "sim_cuda/scene/names.h"

namespace collidoscope {
namespace {

using Json = nlohmann::ordered_json;
constexpr int solver_turn_steps = 6;

/// Residual overlap and motion.
struct SolverResidual {
  StepStats stats;
  double overlap = 0;  ///< overlap of two bodies over the smaller radius, r.m.s. over overlapping pairs
};

SolverResidual residual(const Scene& scene, const RunOptions& options, const BodyStates& bodies) {
  RunState state;
  state.bodies = bodies;
  World world(scene, options, &state);
  SolverResidual left{world.measure(), 0};
  const std::vector<double>& radius = world.initial().radius;
  std::int64_t overlapping = 0;
  for (const auto& [a, b] : world.pairs()) {
    const double gap = (bodies.position[b] - bodies.position[a]).norm() - radius[a] - radius[b];
    if (!(gap < 0)) continue;
    const double share = gap / std::min(radius[a], radius[b]);
    left.overlap += share * share;
    ++overlapping;
  }
  if (overlapping > 0) left.overlap = std::sqrt(left.overlap / static_cast<double>(overlapping));
  return left;
}

struct Contestant {
  std::string name, settings;
  std::optional<World> world;
  std::unique_ptr<BulletBaseline> bullet;
  std::vector<float> ms;  ///< ms per step, one entry per turn

  void turn() {
    const auto start = std::chrono::steady_clock::now();
    if (world)
      world->step(solver_turn_steps);
    else
      for (int k = 0; k < solver_turn_steps; ++k) bullet->step();
    ms.push_back(std::chrono::duration<float, std::milli>(std::chrono::steady_clock::now() - start).count() /
                 solver_turn_steps);
  }
  BodyStates bodies() { return world ? world->bodies() : bullet->bodies(); }
};

void refuse_unsupported_by_bullet(const Scene& scene, const World& world) {
  const Effects effects = world.effects();
  bool moved = false;  // true: the scene has kinematic or fixed bodies
  for (const Motion motion : world.initial().motion) moved |= motion != Motion::dynamic;
  if (effects.drag || effects.attractor || effects.rolling_resistance || effects.sleeping || effects.joints ||
      moved || !world.initial().meshes.empty() || !scene.boxes.empty())
    throw InputError(
        scene.name +
        ": bench solvers supports only spheres, planes and friction; remove drag, attractors, rolling "
        "resistance, sleep, joints, kinematic and fixed bodies, boxes and meshes");
}

std::vector<Contestant> contestants(const Scene& scene, const RunOptions& options, World& first) {
  std::vector<Contestant> all;
  RunState start = first.state();
  Scene ours = scene;
  ours.physics.solver = Solver::soft_step;
  const int substeps = substeps_in_effect(ours.physics);
  const auto text = [](int parts, int sweeps, const char* more) {
    return fmt::format("{} substeps, {} iteration{}{}", parts, sweeps, sweeps > 1 ? "s" : "", more);
  };
  const auto add = [&](const Scene& one, const char* more) {
    Contestant& c = all.emplace_back();
    c.name = name_of(solver_names, one.physics.solver);
    c.settings = text(substeps_in_effect(one.physics), one.physics.iterations, more);
    c.world.emplace(one, options, &start);
  };
  add(ours, "");
  Scene paper = ours;
  paper.physics.solver = Solver::impulse;
  paper.physics.substeps = substeps;
  bool has_friction = false;
  for (Material& material : paper.materials) {
    has_friction |= material.friction != 0;
    material.friction = 0;
  }
  add(paper, has_friction ? ", no friction" : "");
  if (!has_bullet()) return all;
  // Bullet's default step is 1/60 s.
  const int of_60 = std::max(1, static_cast<int>(std::lround(scene.physics.time_step * 60)));
  std::vector<int> parts{of_60};
  if (substeps != of_60) parts.push_back(substeps);
  for (const int each : parts) {
    const BulletSettings settings{each, 10};
    Contestant& c = all.emplace_back();
    c.name = "Bullet";
    c.settings = text(each, settings.iterations, "");
    c.bullet = std::make_unique<BulletBaseline>(first, start.bodies, settings);
  }
  return all;
}

struct SolverRow {
  std::string name, settings;
  Percentiles ms, ratio;  ///< per step; ratio to the first contestant in the same turn
  SolverResidual left;
  std::optional<double> speed;  ///< m/s, mass-weighted r.m.s.; unset if the mass is 0
};

std::vector<SolverRow> solver_rows(std::vector<Contestant>& all, const Scene& scene,
                                   const RunOptions& options, double mass) {
  std::vector<SolverRow> rows;
  for (Contestant& c : all) {
    std::vector<float> ratios;
    for (std::size_t k = 0; k < c.ms.size(); ++k) ratios.push_back(c.ms[k] / all[0].ms[k]);
    SolverRow& row = rows.emplace_back(SolverRow{c.name,
                                                 c.settings,
                                                 percentiles_of(c.ms),
                                                 percentiles_of(ratios),
                                                 residual(scene, options, c.bodies()),
                                                 {}});
    if (mass > 0) row.speed = std::sqrt(2 * row.left.stats.kinetic_energy / mass);
  }
  return rows;
}

std::string speed_text(const SolverRow& row, const char* format, const char* unknown) {
  return row.speed ? fmt::format(fmt::runtime(format), *row.speed) : unknown;
}

struct SolversSetting {
  std::string scene, device;
  StepStats start;
  double time_step = 0;
  int threads = 1;
  std::int64_t steps = 0;
};

std::string solvers_json(const SolversSetting& setting, const std::vector<SolverRow>& rows) {
  Json json{{"suite", "solvers"},
            {"physics_version", physics_version},
            {"scene", setting.scene},
            {"device", setting.device},
            {"threads", setting.threads},
            {"bodies", setting.start.bodies},
            {"time_step", setting.time_step},
            {"steps", setting.steps},
            {"start",
             {{"pairs", setting.start.pairs},
              {"touching", setting.start.touching},
              {"kinetic_energy", setting.start.kinetic_energy},
              {"potential_energy", setting.start.potential_energy},
              {"max_penetration", setting.start.max_penetration}}},
            {"rows", Json::array()}};
  for (const SolverRow& r : rows)
    json["rows"].push_back({{"solver", r.name},
                            {"settings", r.settings},
                            {"step_ms", percentiles_json(r.ms)},
                            {"ratio", percentiles_json(r.ratio)},
                            {"overlap_rms", r.left.overlap},
                            {"max_penetration", r.left.stats.max_penetration},
                            {"kinetic_energy", r.left.stats.kinetic_energy},
                            {"speed_rms", r.speed ? Json(*r.speed) : Json(nullptr)},
                            {"energy_change", r.left.stats.energy() - setting.start.energy()},
                            {"escaped", r.left.stats.escaped}});
  return json_text(json);
}

std::string solvers_csv(const std::vector<SolverRow>& rows) {
  std::string text =
      "solver,settings,step_ms,step_ms_p5,step_ms_p95,ratio,ratio_p5,ratio_p95,overlap_rms,max_penetration,"
      "kinetic_energy,speed_rms\n";
  for (const SolverRow& r : rows)
    text += fmt::format("{},\"{}\",{},{},{},{},{},{},{},{},{},{}\n", r.name, r.settings, r.ms.median, r.ms.p5,
                        r.ms.p95, r.ratio.median, r.ratio.p5, r.ratio.p95, r.left.overlap,
                        r.left.stats.max_penetration, r.left.stats.kinetic_energy, speed_text(r, "{}", ""));
  return text;
}

std::string solvers_markdown(const SolversSetting& setting, const std::vector<SolverRow>& rows) {
  std::string text = fmt::format(
      "{}, N = {}, {} touching pairs, time step {:.4g} s, {} steps; {}, {} thread{}.\n\n"
      "| solver | settings | step, ms (p5 to p95) | ratio to soft_step (p5 to p95) | overlap, r.m.s. | "
      "max. overlap, m | kinetic energy, J | speed, r.m.s., m/s | energy change, J |\n"
      "|---|---|---:|---:|---:|---:|---:|---:|---:|\n",
      setting.scene, grouped(setting.start.bodies), grouped(setting.start.touching), setting.time_step,
      setting.steps, setting.device, setting.threads, setting.threads > 1 ? "s" : "");
  for (const SolverRow& r : rows)
    text += fmt::format(
        "| {} | {} | {:.2f} ({:.2f} to {:.2f}) | {:.2f} ({:.2f} to {:.2f}) | {:.2g} % | {:.2g} | "
        "{:.2g} | {} | {:.2g} |\n",
        r.name == "Bullet" ? r.name : fmt::format("`{}`", r.name), r.settings, r.ms.median, r.ms.p5, r.ms.p95,
        r.ratio.median, r.ratio.p5, r.ratio.p95, 100 * r.left.overlap, r.left.stats.max_penetration,
        r.left.stats.kinetic_energy, speed_text(r, "{:.2g}", "-"),
        r.left.stats.energy() - setting.start.energy());
  return text;
}

std::string solvers_text(const SolversSetting& setting, const std::vector<SolverRow>& rows) {
  std::string text =
      fmt::format("{}, N = {}, {} touching pairs; {} steps of {:.4g} s on {}, {} thread{}\n\n", setting.scene,
                  grouped(setting.start.bodies), grouped(setting.start.touching), setting.steps,
                  setting.time_step, setting.device, setting.threads, setting.threads > 1 ? "s" : "");
  text += fmt::format("{:<10}{:<39} {:>8} {:>21}{:>11}{:>9}{:>10}{:>10}\n", "solver", "", "ms",
                      "ratio to soft_step", "overlap", "depth, m", "J", "m/s");
  for (const SolverRow& r : rows)
    text += fmt::format(
        "{:<10}{:<39} {:>8.2f} {:>21}{:>9.2g} %{:>9.2g}{:>10.2g}{:>10}\n", r.name, r.settings, r.ms.median,
        fmt::format("{:.2f} ({:.2f}-{:.2f})", r.ratio.median, r.ratio.p5, r.ratio.p95), 100 * r.left.overlap,
        r.left.stats.max_penetration, r.left.stats.kinetic_energy, speed_text(r, "{:.2g}", "-"));
  return text;
}

}  // namespace

int bench_solvers(const CommandLine& line) {
  const ResultFiles files(line.options);
  const Scene scene = load_scene(line);
  RunOptions options = line.options.run;
  options.executor = ExecutorKind::cpu;
  if (options.cpu_threads == 0) options.cpu_threads = 1;
  World first(scene, options);
  refuse_unsupported_by_bullet(scene, first);
  const std::int64_t turns = line.options.bench.repeats;
  const SolversSetting setting{scene.name,          first.info().device_name,
                               first.measure(),     scene.physics.time_step,
                               options.cpu_threads, turns * solver_turn_steps};
  double mass = 0;
  for (const double m : first.initial().mass) mass += m;

  std::vector<Contestant> all = contestants(scene, options, first);
  {
    Progress progress("turns", turns);
    for (std::int64_t turn = 0; turn < turns; ++turn) {
      for (Contestant& c : all) c.turn();
      progress.update(turn + 1);
    }
  }
  const std::vector<SolverRow> rows = solver_rows(all, scene, options, mass);
  files.write(solvers_json(setting, rows), solvers_csv(rows), solvers_markdown(setting, rows));
  print(line.options.json == "-" ? solvers_json(setting, rows) : solvers_text(setting, rows));
  return 0;
}

}  // namespace collidoscope

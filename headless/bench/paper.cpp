#include "headless/bench/paper.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>

#include "headless/bench/paper_report.h"
#include "headless/cli/progress.h"
#include "headless/cli/standard_output.h"
#include "headless/reporting/result_files.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/world.h"

namespace collidoscope {
namespace {

/// Number of repeats. A repeat has two steps; the second has stage timing.
struct Repeats {
  std::int64_t exactly = 0;  ///< 0: as many as fit in two seconds, at most 20
  bool enough(std::int64_t done, std::chrono::steady_clock::time_point start) const {
    if (exactly > 0) return done >= exactly;
    return done >= 20 || std::chrono::steady_clock::now() - start >= std::chrono::seconds(2);
  }
};

PaperTiming time_steps(Scene scene, RunOptions run, const char* method, PaperQuery query, std::int64_t bodies,
                       LaunchShape shape, Repeats repeats) {
  scene.generators[0].count = bodies;
  run.broad_phase = method;
  run.shape = shape;
  run.whole_queries = query == PaperQuery::whole;
  if (run.sort == SortMethod::automatic) run.sort = SortMethod::radix;  // the paper's sort
  World world(scene, run);
  std::vector<float> forwarding, collisions, both, pairs, sort, build;
  PaperTiming timing;
  const auto start = std::chrono::steady_clock::now();
  do {
    world.step(2);  // the second step has stage timing
    float forward = 0, collide = 0;
    std::map<std::string, float> stages;
    timing.launches = 0;
    for (const StageTime& stage : world.latest_times().stages) {
      const auto ms = static_cast<float>(stage.last_ms);
      (stage.name == "move" ? forward : collide) += ms;
      stages[stage.name] = ms;
      timing.launches += stage.launches;
    }
    forwarding.push_back(forward);
    collisions.push_back(collide);
    both.push_back(forward + collide);
    pairs.push_back(stages["pairs"]);
    sort.push_back(stages["sort"]);
    build.push_back(stages["build"]);
  } while (!repeats.enough(std::ssize(both), start));
  timing.forwarding = percentiles_of(forwarding);
  timing.collisions = percentiles_of(collisions);
  timing.both = percentiles_of(both);
  timing.pairs_stage = percentiles_of(pairs);
  timing.sort_stage = percentiles_of(sort);
  timing.build_stage = percentiles_of(build);
  timing.whole_step = world.times().step_median_ms;
  timing.pairs = world.measure().pairs;
  timing.bytes = world.info().allocated_bytes;
  timing.steps = static_cast<int>(world.steps());
  timing.timed = static_cast<int>(std::ssize(both));
  timing.key_bits = world.info().key_bits;
  return timing;
}

/// A row to measure.
struct Wanted {
  PaperCell cell;
  PaperQuery query;
};

std::vector<Wanted> wanted_rows(const std::vector<std::int64_t>& sizes) {
  std::vector<Wanted> wanted;
  for (const PaperCell& cell : paper_cells()) {
    if (!sizes.empty() && std::ranges::find(sizes, cell.bodies) == sizes.end()) continue;
    if (cell.table <= 2)
      wanted.push_back({cell, PaperQuery::none});
    else
      for (const PaperQuery query : {PaperQuery::whole, PaperQuery::half}) wanted.push_back({cell, query});
  }
  return wanted;
}

}  // namespace

int bench_paper(const CommandLine& line) {
  const Options& options = line.options;
  Scene scene = load_scene(line);
  if (!options.overrides.settings.has<&Physics::solver>())
    scene.physics.solver = Solver::impulse;  // the paper's solver
  if (scene.generators.size() != 1)
    throw InputError(
        scene.name +
        ": bench paper varies the number of bodies; expected a scene with exactly one generator");
  const std::vector<Wanted> wanted = wanted_rows(options.bench.sizes);
  if (wanted.empty())
    throw InputError("--sizes: not in the paper's tables; expected 100, 500, 1000, 5000, 10000 or 50000");
  const ResultFiles files(options);

  // Tables 2, 4 and 5 share their runs.
  std::map<std::tuple<std::string, PaperQuery, std::int64_t, int, int>, PaperTiming> known;
  const std::int64_t asked = options.bench.repeats_given ? options.bench.repeats : 0;
  std::map<std::int64_t, std::int64_t> repeats;  // by number of bodies; default: set by the first run
  PaperResults results;
  {
    const World world(scene, options.run);
    results.device = world.info().device_name;
  }
  const auto write = [&] { files.write(paper_json(results), paper_csv(results), paper_text(results, true)); };
  const std::vector<LaunchShape> recursion_shapes{{16, 16}, {0, 0}};
  Progress progress("rows", std::ssize(wanted) + std::ssize(recursion_shapes));
  for (const auto& [cell, query] : wanted) {
    progress.update(std::ssize(results.rows));
    const char* method = cell.table == 1   ? "brute_force"
                         : cell.table == 3 ? "lbvh_top_down"
                                           : "bvh_bottom_up";
    const PaperQuery run_by = cell.table == 2 ? PaperQuery::whole : query;
    const auto key = std::tuple(std::string(method), run_by, cell.bodies, cell.blocks, cell.threads);
    if (!known.contains(key)) {
      std::int64_t& times = repeats[cell.bodies];
      if (asked > 0) times = asked;
      known[key] =
          time_steps(scene, options.run, method, run_by, cell.bodies, {cell.blocks, cell.threads}, {times});
      times = known[key].timed;
    }
    const PaperTiming& t = known[key];
    results.rows.push_back({cell, query,
                            cell.table == 1   ? t.pairs_stage
                            : cell.table == 2 ? t.forwarding
                            : cell.table == 5 ? t.both
                                              : t.collisions,
                            t});
    write();
  }
  const std::int64_t largest =
      std::ranges::max(wanted, {}, [](const Wanted& w) { return w.cell.bodies; }).cell.bodies;
  for (const LaunchShape shape : recursion_shapes) {
    progress.update(std::ssize(results.rows) + std::ssize(results.recursions));
    const auto query_ms = [&](const char* method) {
      return time_steps(scene, options.run, method, PaperQuery::whole, largest, shape, {asked}).pairs_stage;
    };
    results.recursions.push_back({largest, shape, query_ms("bvh_bottom_up"), query_ms("bvh_recursive")});
    write();
  }
  files.plot(paper_chart(results));
  print(options.json == "-" ? paper_json(results) : paper_text(results, false));
  return 0;
}

}  // namespace collidoscope

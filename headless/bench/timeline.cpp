#include "headless/bench/timeline.h"

#include <fmt/format.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <vector>

#include "headless/cli/progress.h"
#include "headless/cli/standard_output.h"
#include "headless/reporting/percentiles.h"
#include "headless/reporting/percentiles_json.h"
#include "headless/reporting/report.h"
#include "headless/reporting/result_files.h"
#include "sim_cuda/core/hash.h"
#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/recording/timeline.h"

namespace collidoscope {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::int64_t timeline_steps = 10'000;

struct TimelineCost {
  double plain_seconds = 0, recorded_seconds = 0;  ///< of all steps, without and with a timeline
  std::vector<float> jump_ms;                      ///< to a state chosen at random
  /// Part of the time of the steps that the timeline adds.
  double share() const { return recorded_seconds / plain_seconds - 1; }
};

/// Calls `work` and returns the seconds that it took.
template <class Work>
double seconds_of(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Simulates with a timeline and without it, in turns, because clock rates vary.
TimelineCost measure_timeline(World& world, World& plain, Timeline& timeline, std::int64_t jumps) {
  constexpr std::int64_t steps_per_turn = 100;
  TimelineCost cost;
  plain.restore(world);
  timeline.begin(world);
  Progress progress("steps", timeline_steps);
  for (std::int64_t step = 1; step <= timeline_steps; ++step) {
    cost.recorded_seconds += seconds_of([&] {
      const double seconds = seconds_of([&] { world.step(); });
      timeline.record_step(world, seconds);
    });
    if (step % steps_per_turn == 0)
      cost.plain_seconds += seconds_of([&] {
        for (std::int64_t k = 0; k < steps_per_turn; ++k) plain.step();
      });
    progress.update(step);
  }
  for (std::int64_t jump = 0; jump < jumps; ++jump) {
    const auto state =
        static_cast<std::int64_t>(mix64(static_cast<std::uint64_t>(jump)) % std::uint64_t{timeline_steps});
    cost.jump_ms.push_back(
        static_cast<float>(1e3 * seconds_of([&] { timeline.world_at(state, world.options()); })));
  }
  return cost;
}

}  // namespace

int bench_timeline(const CommandLine& line) {
  const ResultFiles files(line.options);
  const Scene scene = load_scene(line);
  World world(scene, line.options.run), plain(scene, line.options.run);
  Timeline timeline;
  const TimelineCost cost = measure_timeline(world, plain, timeline, line.options.bench.repeats);
  const Percentiles jump = percentiles_of(cost.jump_ms);
  Json json{{"suite", "timeline"},
            {"physics_version", physics_version},
            {"device", world.info().device_name},
            {"scene", scene.name},
            {"bodies", world.initial().size()},
            {"steps", timeline_steps},
            {"step_ms", 1e3 * cost.plain_seconds / static_cast<double>(timeline_steps)},
            {"recording_share", cost.share()},
            {"keyframes", timeline.keyframes().size()},
            {"keyframe_bytes", timeline.bytes()},
            {"jump_ms", percentiles_json(jump)}};
  files.write(json_text(json), "", "");
  print(line.options.json == "-"
            ? json_text(json)
            : fmt::format("{}, {} bodies, {} steps of {:.3f} ms on {}: {} keyframes of {:.1f} MiB in all, "
                          "which take {:.1f} % "
                          "of the time; to a random state: median {:.1f} ms, 95th percentile {:.1f} ms\n",
                          scene.name, world.initial().size(), timeline_steps,
                          1e3 * cost.plain_seconds / static_cast<double>(timeline_steps),
                          world.info().device_name, timeline.keyframes().size(),
                          static_cast<double>(timeline.bytes()) / 1048576, 100 * cost.share(), jump.median,
                          jump.p95));
  return 0;
}

}  // namespace collidoscope

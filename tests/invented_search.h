#pragma once
// A search over invented times, with every kind of cell, for tests of the outputs of `tune`.

#include <chrono>
#include <cmath>

#include "headless/tuning/tuned_run.h"

namespace collidoscope {

inline constexpr LaunchShape wrong_shape{132, 1024};

/// 48 shapes around 132 multiprocessors, best near 264 x 128. T = 1024 with many blocks is infeasible, and
/// `wrong_shape` leads to another hash. `pairs`: the time ends after so many; other shapes stay unmeasured.
inline LaunchSearch invented_search(int pairs = 1'000'000) {
  LaunchSearch search({8, 16, 33, 66, 132, 264, 528, 1056}, {32, 64, 128, 256, 512, 1024}, 32, 512 * 132);
  while (const auto task = search.next()) {
    const LaunchShape shape = search.cells()[task->cell].shape;
    if (shape.threads == 1024 && shape.blocks >= 528) {
      search.exclude(task->cell, LaunchCell::State::infeasible, "too many resources requested for launch");
      continue;
    }
    const double b = std::log2(shape.blocks / 264.0), t = std::log2(shape.threads / 128.0);
    const double exact = 2.28 * (1 + 0.012 * b * b + 0.015 * t * t + (b + t < -2 ? 0.3 * (-2 - b - t) : 0));
    for (int pair = 0; pair < task->pairs; ++pair, --pairs)
      search.add(task->cell, exact * (1 + 0.006 * (pair * 7 % 5 - 2)), 2.36);
    if (shape == wrong_shape)
      search.exclude(task->cell, LaunchCell::State::wrong, "state 62: hash 0000000000000001, expected 2");
    if (pairs < 0) search.hurry();
  }
  return search;
}

inline TunedRun invented_run(const LaunchSearch& search) {
  TunedRun run{.scene = "Box Collider",
               .device = "A GPU",
               .executor = "cuda",
               .broad_phase = "lbvh_ropes",
               .bodies = 50'000,
               .state = 60,
               .physics_version = 9,
               .reference = {},
               .reference_ms = 2.36,
               .reference_place = StageShape{"solve", {528, 256}},
               .cell_times = {}};
  CellTimes times;
  times.search = 0.25;
  times.setup = 5;
  times.benchmark = 40;
  times.check = 1.5;
  times.measured_at = std::chrono::system_clock::from_time_t(1'767'323'045);  // 2026-01-02 03:04:05 UTC
  run.cell_times.assign(search.cells().size(), times);
  return run;
}

}  // namespace collidoscope

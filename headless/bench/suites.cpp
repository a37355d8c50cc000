#include "headless/bench/suites.h"

#include <algorithm>

#include "headless/bench/broad_phases.h"
#include "headless/bench/effects.h"
#include "headless/bench/frames.h"
#include "headless/bench/paper.h"
#include "headless/bench/predictors.h"
#include "headless/bench/scaling.h"
#include "headless/bench/solvers.h"

namespace collidoscope {
namespace {

constexpr Suite every[] = {
    {"broad-phases", "each broad phase, over variants and numbers of bodies", bench_broad_phases},
    {"scaling", "how the time of each broad phase grows with N, fitted", bench_scaling},
    {"predictors", "which measure of a tree's quality predicts the time of its queries", bench_predictors},
    {"paper", "the Tables 1 to 5 of the term project that this program carries on", bench_paper},
    {"solvers", "our solvers and Bullet's on one pile: time, overlap, energy", bench_solvers},
    {"effects", "that an effect which is off costs nothing; and what one that is on costs", bench_effects},
    {"frames", "what a frame of the live view costs: simulate, publish, draw, panels", bench_frames},
};

}  // namespace

std::span<const Suite> suites() { return every; }

int bench_command(const CommandLine& line) {
  return std::ranges::find(every, line.suite, [](const Suite& one) { return one.name; })->run(line);
}

}  // namespace collidoscope

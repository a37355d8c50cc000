#include "headless/bench/suites.h"

#include <algorithm>

#include "headless/bench/broad_phases.h"
#include "headless/bench/effects.h"
#include "headless/bench/frames.h"
#include "headless/bench/live.h"
#include "headless/bench/paper.h"
#include "headless/bench/predictors.h"
#include "headless/bench/scaling.h"
#include "headless/bench/solvers.h"
#include "headless/bench/timeline.h"

namespace collidoscope {
namespace {

constexpr std::string_view of_sweeps = "--methods --variants --sizes --repeats --csv --markdown --plot";
constexpr Suite every[] = {
    {"broad-phases", "time of each broad phase over variants and numbers of bodies", of_sweeps,
     bench_broad_phases},
    {"scaling", "fitted growth of the time of each broad phase with N", of_sweeps, bench_scaling},
    {"predictors", "rank correlation of tree quality measures with query time", of_sweeps, bench_predictors},
    {"paper", "Tables 1 to 5 of the term project that preceded this program",
     "--sizes --repeats --csv --markdown --plot", bench_paper},
    {"solvers", "soft_step, impulse and Bullet on one pile: time, overlap, energy",
     "--repeats --csv --markdown", bench_solvers},
    {"effects", "cost of each effect; a disabled effect must add no launch and no buffer",
     "--repeats --csv --markdown", bench_effects},
    {"timeline", "time to reach an earlier state of a run of 10,000 steps, and the cost of keyframes",
     "--repeats", bench_timeline},
    {"live", "step rate of a run in a window, over that of the run alone; frames per second",
     "--repeats --layers --color --box-color --box-range --size --display-path --draw-gpu --quality "
     "--supersample "
     "--sphere-method --light-method",
     bench_live},
    {"frames", "frame time of the viewer: simulate, publish, draw, panels",
     "--frames --layers --color --box-color --box-range --size --display-path --draw-gpu --quality "
     "--supersample "
     "--sphere-method --light-method",
     bench_frames},
};

}  // namespace

std::span<const Suite> suites() { return every; }

int bench_command(const CommandLine& line) {
  return std::ranges::find(every, line.suite, [](const Suite& one) { return one.name; })->run(line);
}

}  // namespace collidoscope

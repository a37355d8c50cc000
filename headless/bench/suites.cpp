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

constexpr std::string_view of_sweeps = "--methods --variants --sizes --repeats --csv --markdown --plot";
constexpr Suite every[] = {
    {"broad-phases", "each broad phase, over variants and numbers of bodies", of_sweeps, bench_broad_phases},
    {"scaling", "how the time of each broad phase grows with N, fitted", of_sweeps, bench_scaling},
    {"predictors", "which measure of a tree's quality predicts the time of its queries", of_sweeps,
     bench_predictors},
    {"paper", "the Tables 1 to 5 of the term project that this program carries on",
     "--sizes --repeats --csv --markdown --plot", bench_paper},
    {"solvers", "our solvers and Bullet's on one pile: time, overlap, energy", "--repeats --csv --markdown",
     bench_solvers},
    {"effects", "that an effect which is off adds no launch and no buffer; and what one that is on costs",
     "--repeats --csv --markdown", bench_effects},
    {"frames", "what a frame of the live view costs: simulate, publish, draw, panels",
     "--frames --layers --color --box-color --box-range --size --display-path --quality --supersample "
     "--sphere-method",
     bench_frames},
};

}  // namespace

std::span<const Suite> suites() { return every; }

int bench_command(const CommandLine& line) {
  return std::ranges::find(every, line.suite, [](const Suite& one) { return one.name; })->run(line);
}

}  // namespace collidoscope

#include "headless/bench/suites.h"

#include <algorithm>

#include "headless/bench/frames.h"

namespace collidoscope {
namespace {

constexpr Suite every[] = {
    {"frames", "what a frame of the live view costs: simulate, publish, draw, panels", bench_frames},
};

}  // namespace

std::span<const Suite> suites() { return every; }

int bench_command(const CommandLine& line) {
  return std::ranges::find(every, line.suite, [](const Suite& one) { return one.name; })->run(line);
}

}  // namespace collidoscope

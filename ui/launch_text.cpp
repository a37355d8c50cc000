#include "ui/launch_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "ui/widgets.h"

namespace collidoscope {
namespace {

std::string cpu_text(const StageLaunch& launch) {
  return fmt::format("{} item{} in {} chunk{} of {}, on {} thread{}", grouped_number(launch.items),
                     launch.items == 1 ? "" : "s", grouped_number(launch.blocks),
                     launch.blocks == 1 ? "" : "s", grouped_number(launch.chunk), launch.threads,
                     launch.threads == 1 ? "" : "s");
}

std::string gpu_text(const StageLaunch& launch) {
  std::string text = fmt::format("{} block{} of {} threads for {} item{}\n", grouped_number(launch.blocks),
                                 launch.blocks == 1 ? "" : "s", launch.threads, grouped_number(launch.items),
                                 launch.items == 1 ? "" : "s");
  text += fmt::format("{} registers per thread, {} bytes of shared memory per block\n", launch.registers,
                      grouped_number(launch.shared_bytes));
  text += fmt::format("{} resident blocks on each of {} multiprocessors: occupancy {:.0f} %",
                      launch.resident_blocks, launch.multiprocessors, 100 * launch.occupancy);
  switch (launch.limit) {
    case LaunchLimit::items:
      return text + "\ntoo few items to fill the GPU";
    case LaunchLimit::shape:
      return text + fmt::format("\nlimited by the requested (B, T): room for {} more blocks",
                                grouped_number(launch.resident() - launch.blocks));
    case LaunchLimit::threads:
      return text + "\nlimited by threads per multiprocessor";
    default:
      return text + fmt::format("\nlimited by {}", name_of(launch.limit));
  }
}

std::string range_text(std::int64_t least, std::int64_t most) {
  if (least == most) return grouped_number(least);
  return grouped_number(least) + " to " + grouped_number(most);
}

}  // namespace

std::string launch_text(const History::Stage& stage) {
  const StageLaunch& launch = stage.launch;
  std::string text;
  if (stage.library_launch)
    text = launch.threads == 0 ? "library launch shape: independent of (B, T)"
                               : "* some kernels have a library launch shape, independent of (B, T)";
  if (launch.threads == 0) return text;
  if (stage.launches > 1) text += (text.empty() ? "" : "\n") + std::string("largest kernel:");
  return text + (text.empty() ? "" : "\n") +
         (launch.multiprocessors > 0 ? gpu_text(launch) : cpu_text(launch));
}

LaunchRange launch_range(const History& history) {
  std::vector<StageLaunch> launches;
  for (std::size_t k = 0; k < history.stages().size(); ++k)
    if (history.stages()[k].launch.threads > 0 && history.current(k))
      launches.push_back(history.stages()[k].launch);
  LaunchRange range;
  if (launches.empty()) return range;
  const auto ends = [&](auto member) {
    const auto [least, most] = std::ranges::minmax(launches, {}, member);
    return std::pair{least.*member, most.*member};
  };
  const auto [fewest, most] = ends(&StageLaunch::threads);
  if (launches.front().multiprocessors == 0) {
    range.lines = {fmt::format("CPU: chunks of {} items on {} thread{}",
                               grouped_number(ends(&StageLaunch::chunk).second), most, most == 1 ? "" : "s")};
    return range;
  }
  const auto [low, high] = ends(&StageLaunch::blocks);
  const auto [least, best] = ends(&StageLaunch::occupancy);
  range.blocks = range_text(low, high);
  range.threads = range_text(fewest, most);
  range.lines = {
      fmt::format("occupancy {} %", range_text(std::lround(100 * least), std::lround(100 * best)))};
  std::map<LaunchLimit, int> limits;
  for (const StageLaunch& launch : launches) ++limits[launch.limit];
  for (const auto& [limit, stages] : limits)
    range.lines.push_back(fmt::format("{} stage{}: {}", stages, stages == 1 ? "" : "s", name_of(limit)));
  return range;
}

}  // namespace collidoscope

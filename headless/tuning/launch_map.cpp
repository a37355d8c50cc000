#include "headless/tuning/launch_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "ui/widgets.h"
#include "viewer/render/colors.h"

namespace collidoscope {
namespace {

/// Slower shapes have the last colour.
constexpr double most_ratio = 1.5;  // to the fastest

std::string ratio_text(double ratio) {
  return ratio < 9.995 ? fmt::format("{:.2f}", ratio) : fmt::format("{:.{}f}", ratio, ratio < 99.95 ? 1 : 0);
}

HeatCell::Kind kind_of(LaunchCell::State state) {
  switch (state) {
    case LaunchCell::State::measured:
      return HeatCell::Kind::value;
    case LaunchCell::State::infeasible:
      return HeatCell::Kind::hatched;
    case LaunchCell::State::wrong:
      return HeatCell::Kind::crossed;
    case LaunchCell::State::left_out:
      return HeatCell::Kind::dashed;
    case LaunchCell::State::waiting:
      break;
  }
  return HeatCell::Kind::empty;
}

/// From bright to dark.
std::vector<std::uint32_t> map_colors() {
  std::vector<std::uint32_t> colors;
  const auto byte = [](float part) { return static_cast<std::uint32_t>(std::lround(255 * part)); };
  for (const Rgb& c : color_map())
    colors.push_back(0xff000000u | byte(c.b) << 16 | byte(c.g) << 8 | byte(c.r));
  std::ranges::reverse(colors);
  return colors;
}

std::string pairs_text(const LaunchSearch& search) {
  std::int64_t fewest = std::numeric_limits<std::int64_t>::max(), most = 0;
  for (const LaunchCell& cell : search.cells()) {
    if (cell.state != LaunchCell::State::measured) continue;
    fewest = std::min<std::int64_t>(fewest, std::ssize(cell.ratios));
    most = std::max<std::int64_t>(most, std::ssize(cell.ratios));
  }
  return fewest < most ? fmt::format("{} to {} pairs", fewest, most) : fmt::format("{} pairs", most);
}

}  // namespace

HeatMap launch_map(const TunedRun& run, const LaunchSearch& search) {
  const std::string reference = shape_text(run.reference);
  const bool automatic = run.reference == LaunchShape{};
  HeatMap map;
  map.title =
      fmt::format("{}, {} bodies: time of a step by launch shape", run.scene, grouped_number(run.bodies));
  map.subtitle = fmt::format("{} ({}), state {}", run.device, run.executor, run.state);
  if (std::isfinite(run.reference_ms))
    map.subtitle += fmt::format("; {} takes {:.3f} ms", reference, run.reference_ms);
  map.verdict = verdict_line(search, run.reference);
  if (const auto wrong = std::ranges::count(search.cells(), LaunchCell::State::wrong, &LaunchCell::state))
    map.verdict += fmt::format("; error: {} shape{} with another state hash", wrong, wrong == 1 ? "" : "s");
  map.x.label = "blocks B";
  map.y.label = "threads per block T";
  map.number = ratio_text;
  map.colors = map_colors();
  map.bar_label = automatic ? "ratio to auto" : "ratio to current";
  map.second_label = "ms";
  map.second_unit = run.reference_ms;
  map.level = 1;
  map.level_name = automatic ? "auto" : "current";

  std::set<double> blocks, threads;
  const std::vector<std::size_t> plateau = search.plateau();
  const std::optional<std::size_t> chosen = search.chosen();
  double fastest = 1, slowest = 1;
  for (std::size_t k = 0; k < search.cells().size(); ++k) {
    const LaunchCell& cell = search.cells()[k];
    HeatCell one{static_cast<double>(cell.shape.blocks), static_cast<double>(cell.shape.threads),
                 kind_of(cell.state)};
    if (k < search.grid_size()) blocks.insert(one.x), threads.insert(one.y);
    if (one.kind == HeatCell::Kind::value) {
      one.value = cell.estimate().ratio;
      fastest = std::min(fastest, one.value);
      slowest = std::max(slowest, one.value);
      if (std::ranges::find(plateau, k) != plateau.end()) one.frame = HeatCell::Frame::thin;
      if (chosen == k) one.frame = HeatCell::Frame::thick;
    }
    map.cells.push_back(one);
  }
  map.x.values.assign(blocks.begin(), blocks.end());
  map.y.values.assign(threads.begin(), threads.end());
  map.low = fastest;
  map.high = std::max({std::min(slowest, most_ratio * fastest), 1.05 * fastest, 1.0});

  if (run.reference_place) {
    const LaunchShape shape = run.reference_place->shape;
    map.mark = {static_cast<double>(shape.blocks), static_cast<double>(shape.threads)};
    map.mark_name = run.reference_place->stage.empty() ? "current shape"
                                                       : fmt::format("shape of {} for {}, its slowest stage",
                                                                     reference, run.reference_place->stage);
  }
  map.thick_name = "chosen";
  map.thin_name = "cannot be told apart from the fastest";
  map.small_name = "between two shapes";
  map.hatched_name = "infeasible";
  map.crossed_name = "another state hash (error)";
  map.dashed_name = "left out: beyond a much slower shape";
  map.empty_name = "not measured";
  map.note =
      fmt::format("Number in a cell: median ratio of the time of a step to that with {}; {} of measurements",
                  reference, pairs_text(search));
  return map;
}

}  // namespace collidoscope

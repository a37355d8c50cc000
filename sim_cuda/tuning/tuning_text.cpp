#include "sim_cuda/tuning/tuning_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>
#include <vector>

namespace collidoscope {

std::string shape_text(LaunchShape shape) {
  const auto part = [](int value) { return value == 0 ? "auto" : std::to_string(value); };
  if (shape == LaunchShape{}) return "auto";
  return "B = " + part(shape.blocks) + ", T = " + part(shape.threads);
}

std::string stage_shapes_text(const StageShapes& shapes) {
  std::vector<std::string> parts;
  for (const auto& [stage, shape] : shapes)
    parts.push_back(fmt::format("{}={}x{}", stage, shape.blocks, shape.threads));
  return fmt::format("{}", fmt::join(parts, ","));
}

std::string verdict_line(const LaunchSearch& search, LaunchShape reference) {
  const std::optional<std::size_t> chosen = search.chosen();
  if (!chosen) return "no shape was measured; a longer --budget is needed";
  const std::string other = shape_text(reference);
  // A shape that is not faster is not worth a setting.
  const bool faster = search.confirmation().high < 1;
  return fmt::format("{}: {}{}", shape_text(search.cells()[*chosen].shape),
                     verdict(search.confirmation(), other), faster ? "" : "; so keep " + other);
}

}  // namespace collidoscope

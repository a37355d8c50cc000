#include "viewer/render/draw_options.h"

#include <algorithm>

#include "sim_cuda/core/error.h"

namespace collidoscope {

DrawOptions still_options(const DrawRequest& request, int width, int height, int max_side) {
  // Large pictures are not supersampled, to save memory.
  constexpr std::int64_t most_pixels = 16'000'000;
  const bool fits =
      std::int64_t{width} * height <= most_pixels && 2 * std::int64_t{std::max(width, height)} <= max_side;
  return {request.supersampling.value_or(fits ? 2 : 1), request.light.value_or(Quality::full),
          request.spheres, request.light_method};
}

DrawOptions live_options(const DrawRequest& request, bool software, std::int64_t bodies) {
  return {request.supersampling.value_or(software || bodies > max_supersampled ? 1 : 2),
          request.light.value_or(software ? Quality::quick : Quality::full), request.spheres,
          request.light_method};
}

const char* quality_name(Quality quality) { return quality == Quality::full ? "full" : "quick"; }

std::optional<Quality> parse_quality(const std::string& text, const std::string& where) {
  if (text == "auto") return std::nullopt;
  if (text == "full") return Quality::full;
  if (text == "quick") return Quality::quick;
  throw InputError(where + ": '" + text + "': unknown quality; expected one of auto, full, quick");
}

SphereMethod parse_sphere_method(const std::string& text, const std::string& where) {
  if (text == "auto") return SphereMethod::automatic;
  if (text == "quads") return SphereMethod::quads;
  if (text == "compute") return SphereMethod::compute;
  throw InputError(where + ": '" + text + "': unknown sphere method; expected one of auto, quads, compute");
}

LightMethod parse_light_method(const std::string& text, const std::string& where) {
  if (text == "auto") return LightMethod::automatic;
  if (text == "fragments") return LightMethod::fragments;
  if (text == "compute") return LightMethod::compute;
  throw InputError(where + ": '" + text +
                   "': unknown light method; expected one of auto, fragments, compute");
}

}  // namespace collidoscope

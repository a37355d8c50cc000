#pragma once
// Options of a Renderer: supersampling, lighting and sphere method, and their automatic choice. Plain data.

#include <cstdint>
#include <optional>
#include <string>

namespace collidoscope {

/// `quick` omits ambient occlusion and uses coarser, harder shadows. For renderers on the CPU in the window.
enum class Quality { full, quick };

/// Method of drawing spheres. All methods give the same picture; the fastest depends on machine and body
/// count.
enum class SphereMethod {
  automatic,  ///< compute on a GPU with many bodies (limit in Renderer), else quads
  quads,      ///< one rasterised quad per sphere
  compute     ///< compute shaders, for GPUs with few raster units (data centre)
};

/// Method of lighting. Both give the same picture.
enum class LightMethod {
  automatic,  ///< compute on a GPU, else fragments
  fragments,  ///< fragment shaders
  compute     ///< compute shaders, for GPUs with few raster units (data centre)
};

struct DrawOptions {
  int supersampling = 2;  ///< 1 to 4: samples per pixel along each axis
  Quality light = Quality::full;
  SphereMethod spheres = SphereMethod::automatic;
  LightMethod light_method = LightMethod::automatic;
  bool cull_lines = true;  ///< does not change the picture

  friend bool operator==(const DrawOptions&, const DrawOptions&) = default;
};

/// Requested options; unset: automatic.
struct DrawRequest {
  std::optional<int> supersampling;
  std::optional<Quality> light;
  SphereMethod spheres = SphereMethod::automatic;
  LightMethod light_method = LightMethod::automatic;
};

/// Options for still pictures: best quality. `max_side`: maximum texture size of OpenGL, in pixels.
DrawOptions still_options(const DrawRequest& request, int width, int height, int max_side);
/// Options for the window. Automatic supersampling is 2 x 2 with full quality on a GPU up to
/// `max_supersampled` bodies, and 1 above. On the CPU it is 1 with quick quality.
DrawOptions live_options(const DrawRequest& request, bool software, std::int64_t bodies);
constexpr std::int64_t max_supersampled = 250'000;

const char* quality_name(Quality quality);

/// Parses full, quick, or auto (unset). Throws InputError.
std::optional<Quality> parse_quality(const std::string& text, const std::string& where = "--quality");
/// Parses auto, quads or compute. Throws InputError.
SphereMethod parse_sphere_method(const std::string& text, const std::string& where = "--sphere-method");
/// Parses auto, fragments or compute. Throws InputError.
LightMethod parse_light_method(const std::string& text, const std::string& where = "--light-method");

}  // namespace collidoscope

#pragma once
// How a Renderer draws: how finely, in what light, and by which means; and what a live view can afford of it.
// Plain data.

#include <cstdint>
#include <optional>
#include <string>

namespace collidoscope {

/// `quick` leaves out ambient occlusion and takes harder, coarser shadows: for renderers that draw on the
/// CPU, while somebody waits for the next frame.
enum class Quality { full, quick };

/// The picture is the same by either; which is faster depends on the machine and on how many there are.
enum class SphereMethod {
  automatic,  ///< compute where a GPU draws many (Renderer says how many), else quads
  quads,      ///< a quad each, through the rasteriser
  compute     ///< pixels written by compute shaders: data-centre chips have few raster units
};

struct DrawOptions {
  int supersampling = 2;  ///< 1 to 4; that many pixels squared are drawn for each
  Quality light = Quality::full;
  SphereMethod spheres = SphereMethod::automatic;
  bool cull_lines = true;  ///< the picture is the same without

  friend bool operator==(const DrawOptions&, const DrawOptions&) = default;
};

/// What somebody asks for; unset is "auto".
struct DrawRequest {
  std::optional<int> supersampling;
  std::optional<Quality> light;
  SphereMethod spheres = SphereMethod::automatic;
};

/// For captures: the best quality. `max_side`: the largest texture side that OpenGL allows, in pixels.
DrawOptions still_options(const DrawRequest& request, int width, int height, int max_side);
/// Pictures that follow each other while somebody looks. Automatic is 2 x 2 samples in full light up to
/// `max_supersampled` bodies on a GPU, 1 beyond; and 1 in quick light where the CPU draws.
DrawOptions live_options(const DrawRequest& request, bool software, std::int64_t bodies);
constexpr std::int64_t max_supersampled = 250'000;

const char* quality_name(Quality quality);

/// full, quick, or auto, which is unset. Throws InputError.
std::optional<Quality> parse_quality(const std::string& text, const std::string& where = "--quality");
/// auto, quads or compute. Throws InputError.
SphereMethod parse_sphere_method(const std::string& text, const std::string& where = "--sphere-method");

}  // namespace collidoscope

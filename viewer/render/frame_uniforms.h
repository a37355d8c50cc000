#pragma once
// The uniform block of all shaders (assets/shaders/frame.glsl), and how a camera and a scene fill it.

#include "sim_cuda/publish/publish.h"
#include "viewer/render/frame_scene.h"
#include "viewer/render/gl/buffer.h"
#include "viewer/render/orbit_camera.h"

namespace collidoscope {

/// Of the hierarchy, told apart by colour; what lies deeper looks as the last.
inline constexpr int max_levels = 64;

/// std140: every member is a multiple of 16 bytes.
struct FrameUniforms {
  float view[16], projection[16], inverse_view[16], light_clip[16];
  float pixels[4], lens[4], key[4], values[4], scale[4];
  float level_colors[max_levels][4], contact_colors[3][4], marks[box_marks][4];
};
static_assert(sizeof(FrameUniforms) == 4 * 64 + 5 * 16 + (max_levels + 3 + box_marks) * 16);

/// What the colour map spans: of BodyInstance::value, and of the metric of boxes.
struct ValueRange {
  double min = 0, max = 1;
  /// N s, of a contact drawn as the strongest; the weakest has a thousandth of it. 0: none are known, and all
  /// contacts look alike.
  double max_impulse = 0;
  bool logarithmic = false;  ///< in even steps of the logarithm; then min > 0
  /// Of the boxes that are drawn, unless they are coloured by level: their number, and their values.
  std::int64_t boxes = 0;
  double box_min = 0, box_max = 1;
  bool boxes_below = false;  ///< some of them are less than box_min
  double error_scale = 1;    ///< length of a line that shows an error, over the error
};

/// A value's place on the colour map, 0 to 1, is scale * (v - from), with v its logarithm or the value
/// itself.
struct ColorScale {
  double from = 0, scale = 1;
};
/// Of no width: all values lie at the lower end.
ColorScale color_scale(double min, double max, bool logarithmic);

/// `width` x `height` pixels are drawn, `scale` x `scale` of them for each pixel of the picture.
FrameUniforms camera_uniforms(const OrbitCamera& camera, const FrameScene& scene, int width, int height,
                              int scale);
/// The same for the shadow map: the key light looks at all of the scene.
FrameUniforms light_uniforms(const FrameScene& scene, int size);
/// Tells the camera's block where the light's map lies, and which values the colours span.
void set_light(FrameUniforms& camera, const FrameUniforms& light);
void set_values(FrameUniforms& uniforms, const ValueRange& range, bool by_id);
/// The colours of levels where these are shown.
void set_levels(FrameUniforms& uniforms, int first, int last);

}  // namespace collidoscope

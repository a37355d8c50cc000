#pragma once
// The uniform block of all shaders (assets/shaders/frame.glsl), filled from camera and scene.

#include "sim_cuda/publish/publish.h"
#include "viewer/render/frame_scene.h"
#include "viewer/render/gl/buffer.h"
#include "viewer/render/orbit_camera.h"

namespace collidoscope {

/// Number of levels with their own colour. Deeper levels have the colour of the last.
inline constexpr int max_levels = 64;

/// std140 layout: every member is a multiple of 16 bytes.
struct FrameUniforms {
  float view[16], projection[16], inverse_view[16], light_clip[16];
  float pixels[4], lens[4], key[4], values[4], scale[4];
  float level_colors[max_levels][4], contact_colors[3][4], marks[box_marks][4];
};
static_assert(sizeof(FrameUniforms) == 4 * 64 + 5 * 16 + (max_levels + 3 + box_marks) * 16);

/// Value ranges of the colour maps, for BodyInstance::value and for the metric of boxes.
struct ValueRange {
  double min = 0, max = 1;
  /// N s, impulse of the strongest contact colour; the weakest has 1/1000 of it. 0: not recorded, and all
  /// contacts look alike.
  double max_impulse = 0;
  bool logarithmic = false;  ///< logarithmic scale; requires min > 0
  /// Number and value range of the drawn boxes, unless coloured by level.
  std::int64_t boxes = 0;
  double box_min = 0, box_max = 1;
  bool boxes_below = false;  ///< some values are less than box_min
  double error_scale = 1;    ///< length of a drawn error vector over the error
};

/// Position of a value v on the colour map, 0 to 1: scale * (v - from). On a logarithmic scale v is replaced
/// by its logarithm.
struct ColorScale {
  double from = 0, scale = 1;
};
/// A range of zero width maps all values to the lower end.
ColorScale color_scale(double min, double max, bool logarithmic);

/// Uniforms of the camera. Draws `width` x `height` pixels, with `scale` x `scale` samples per pixel of the
/// picture.
FrameUniforms camera_uniforms(const OrbitCamera& camera, const FrameScene& scene, int width, int height,
                              int scale);
/// Uniforms of the shadow map: the key light covers the whole scene.
FrameUniforms light_uniforms(const FrameScene& scene, int size);
/// Copies the transform of the shadow map into the uniforms of the camera.
void set_light(FrameUniforms& camera, const FrameUniforms& light);
void set_values(FrameUniforms& uniforms, const ValueRange& range, bool by_id);
/// Sets the level colours for the shown levels.
void set_levels(FrameUniforms& uniforms, int first, int last);

}  // namespace collidoscope

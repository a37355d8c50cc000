#include "viewer/render/frame_uniforms.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "viewer/render/colors.h"

namespace collidoscope {
namespace {

void store(float (&to)[16], const Eigen::Matrix4d& from) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) to[4 * column + row] = static_cast<float>(from(row, column));
}

void store(float (&to)[4], double x, double y, double z, double w) {
  to[0] = static_cast<float>(x);
  to[1] = static_cast<float>(y);
  to[2] = static_cast<float>(z);
  to[3] = static_cast<float>(w);
}

// Key light: from above, from the left of the standard view and slightly from behind the eye.
const Vector3d key_direction = Vector3d(-0.26, -0.52, 0.82).normalized();

}  // namespace

FrameUniforms camera_uniforms(const OrbitCamera& camera, const FrameScene& scene, int width, int height,
                              int scale) {
  FrameUniforms result{};
  const double reach = (camera.eye() - scene.bounds.center()).norm() + scene.bounds.diagonal();
  const double near = camera.orthographic ? -reach : std::max(1e-4 * camera.distance, 1e-6 * reach);
  const double aspect = static_cast<double>(width) / height;
  const Eigen::Matrix4d view = camera.view(), projection = camera.projection(aspect, near, 3 * reach);
  store(result.view, view);
  store(result.projection, projection);
  store(result.inverse_view, view.inverse());
  store(result.pixels, width, height, 1.0 / width, 1.0 / height);
  store(result.lens, 1 / projection(0, 0), 1 / projection(1, 1), camera.orthographic ? 0 : 1, near);
  store(result.key, key_direction.x(), key_direction.y(), key_direction.z(), 1);
  store(result.values, 0, 1, 0, scale);
  store(result.scale,
        std::clamp(3.2 * scene.body_size, 0.004 * scene.bounds.diagonal(), scene.bounds.diagonal()),
        scene.grid_spacing, 0, 0);
  for (int k = 0; k < 3; ++k) {
    const Rgb color = contact_color(0.5 * k);
    store(result.contact_colors[k], color.r, color.g, color.b, 1);
  }
  for (std::size_t k = 0; k < box_marks; ++k) {
    const auto [color, half_width] = mark_style(static_cast<BoxMark>(k));
    store(result.marks[k], color.r, color.g, color.b, half_width);
  }
  return result;
}

FrameUniforms light_uniforms(const FrameScene& scene, int size) {
  OrbitCamera light;
  light.orthographic = true;
  light.azimuth = std::atan2(key_direction.y(), key_direction.x());
  light.elevation = std::asin(key_direction.z());
  light = frame_all(scene.bounds, 1, light, 1.02);
  FrameUniforms result = camera_uniforms(light, scene, size, size, 1);
  result.key[3] = static_cast<float>(2 * light.distance * std::tan(0.5 * light.field_of_view));
  return result;
}

void set_light(FrameUniforms& camera, const FrameUniforms& light) {
  const Eigen::Map<const Eigen::Matrix4f> view(light.view), projection(light.projection);
  const Eigen::Matrix4f clip = projection * view;
  std::memcpy(camera.light_clip, clip.data(), sizeof camera.light_clip);
  camera.key[3] = light.key[3];
}

void set_levels(FrameUniforms& uniforms, int first, int last) {
  for (int level = 0; level < max_levels; ++level) {
    const Rgb color = level_color(level, first, last);
    store(uniforms.level_colors[level], color.r, color.g, color.b, 1);
  }
}

ColorScale color_scale(double min, double max, bool logarithmic) {
  const double from = logarithmic ? std::log(min) : min, width = (logarithmic ? std::log(max) : max) - from;
  return {from, width > 0 ? 1 / width : 0};
}

void set_values(FrameUniforms& uniforms, const ValueRange& range, bool by_id) {
  const ColorScale bodies = color_scale(range.min, range.max, range.logarithmic);
  uniforms.values[0] = static_cast<float>(bodies.from);
  uniforms.values[1] = static_cast<float>(bodies.scale);
  uniforms.values[2] = by_id ? 1 : range.logarithmic ? 2 : 0;
  uniforms.scale[2] = range.max_impulse > 0 ? static_cast<float>(1 / range.max_impulse) : 0;
}

}  // namespace collidoscope

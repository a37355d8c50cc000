#pragma once
// Lights a picture from albedo, normal and depth: shadow map of the key light, ambient occlusion, shading,
// backdrop. Owns its programs, the shadow map and the occlusion targets.

#include <optional>

#include "viewer/render/draw_options.h"
#include "viewer/render/gl/pixel_pass.h"
#include "viewer/render/gl/target.h"

namespace collidoscope {

class LightPass {
 public:
  /// `compute`: uses compute shaders.
  LightPass(Quality quality, bool compute);
  /// Size of the picture in pixels, with `scale` x `scale` samples per pixel.
  void resize(int width, int height);
  /// The shadow map: bound, and ready for drawing bodies. `clear`: false to draw more bodies into it.
  const gl::Target& begin_shadows(bool clear = true) const;
  /// Lights `surface` (albedo, normal, depth) into `lit`, which shares the depth of `surface`.
  void draw(const gl::Target& surface, const gl::Target& lit) const;

  /// Side length of the shadow map in pixels.
  int shadow_size() const { return shadow_.width(); }

 private:
  bool quick_;
  gl::PixelPass occlusion_, blur_, lighting_;
  std::optional<gl::PixelPass> backdrop_;  ///< fragment shaders only
  gl::Target shadow_;
  std::optional<gl::Target> rough_, smooth_;
};

}  // namespace collidoscope

#pragma once
// Turns albedo, normal and depth into a lit picture: shadow map of the key light, ambient occlusion, shading,
// backdrop. Owns its programs, the shadow map and the occlusion targets.

#include <optional>

#include "viewer/render/body_pass.h"
#include "viewer/render/frame_uniforms.h"
#include "viewer/render/gl/target.h"

namespace collidoscope {

/// `quick` leaves out ambient occlusion and takes harder, coarser shadows: for renderers that draw on the
/// CPU, while somebody waits for the next frame.
enum class Quality { full, quick };

class LightPass {
 public:
  explicit LightPass(Quality quality);
  /// The picture's size in pixels; `scale` x `scale` pixels are drawn for each.
  void resize(int width, int height);
  /// Binds the light's uniforms, and leaves them bound.
  void draw_shadows(const gl::Buffer& light_uniforms, const BodyPass& bodies,
                    const InstanceBuffers& instances, bool any_bodies, GLuint colors) const;
  /// From `surface` (albedo, normal, depth) into `lit`.
  void draw(const gl::Target& surface, const gl::Target& lit) const;

  /// Pixels of a side of the shadow map.
  int shadow_size() const { return shadow_.width(); }

 private:
  Quality quality_;
  gl::Program occlusion_, blur_, lighting_;
  gl::VertexLayout nothing_;
  gl::Target shadow_;
  std::optional<gl::Target> rough_, smooth_;
};

}  // namespace collidoscope

#pragma once
// Turns albedo, normal and depth into a lit picture: shadow map of the key light, ambient occlusion, shading,
// backdrop. Owns its programs, the shadow map and the occlusion targets.

#include <optional>

#include "viewer/render/draw_options.h"
#include "viewer/render/gl/program.h"
#include "viewer/render/gl/target.h"
#include "viewer/render/gl/vertex_layout.h"

namespace collidoscope {

class LightPass {
 public:
  explicit LightPass(Quality quality);
  /// The picture's size in pixels; `scale` x `scale` pixels are drawn for each.
  void resize(int width, int height);
  /// Where the light's depth goes: cleared and bound, with the state that bodies are drawn in.
  const gl::Target& begin_shadows() const;
  /// From `surface` (albedo, normal, depth) into `lit`, whose depth is that of `surface`, too.
  void draw(const gl::Target& surface, const gl::Target& lit) const;

  /// Pixels of a side of the shadow map.
  int shadow_size() const { return shadow_.width(); }

 private:
  bool quick_;
  gl::Program occlusion_, blur_, lighting_, backdrop_;
  gl::VertexLayout nothing_;
  gl::Target shadow_;
  std::optional<gl::Target> rough_, smooth_;
};

}  // namespace collidoscope

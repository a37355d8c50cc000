#pragma once
// Draws supports. The floor of the box and obstacle planes are discs with a grid; they fade at the edge and
// end at other planes and walls. Obstacle boxes are solid. Scenes without planes get a faint reference grid.
// Owns its shaders and records; part of a Renderer.

#include <cstdint>

#include "viewer/render/frame_scene.h"
#include "viewer/render/gl/buffer.h"
#include "viewer/render/gl/program.h"
#include "viewer/render/gl/vertex_layout.h"

namespace collidoscope {

class PlanePass {
 public:
  PlanePass();
  void set_scene(const FrameScene& scene);

  /// Planes seen from the front, drawn into the surfaces: they occlude, and are lit and shadowed.
  void draw_surfaces() const;
  /// Planes seen from behind and the reference grid, blended over the lit picture with depth test.
  void draw_veils() const;

 private:
  void draw(const gl::Program& program) const;

  gl::Program surface_, veil_, obstacle_;
  gl::VertexLayout nothing_;
  gl::Buffer planes_{"planes"}, boxes_{"box obstacles"};
  int count_ = 0, box_count_ = 0;
};

}  // namespace collidoscope

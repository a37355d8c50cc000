#pragma once
// Draws what bodies rest on: the floor of the box and the planes among the obstacles, each as a gridded disc
// that fades at its edge and ends where another plane or a wall begins; boxes among the obstacles; and, where
// there is no plane, a faint grid for reference. Owns its shaders and what they draw; belongs to a Renderer.

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

  /// Those seen from the side of the bodies, into the surfaces: they hide, and are lit and shadowed.
  void draw_surfaces() const;
  /// Those seen from behind, and the reference grid: blended over the lit picture, tested against its depth.
  void draw_veils() const;

 private:
  void draw(const gl::Program& program) const;

  gl::Program surface_, veil_, obstacle_;
  gl::VertexLayout nothing_;
  gl::Buffer planes_{"planes"}, boxes_{"box obstacles"};
  int count_ = 0, box_count_ = 0;
};

}  // namespace collidoscope

#pragma once
// Draws where a reference has the bodies: ghosts, translucent spheres with a bright outline, and lines from
// each body towards its ghost. First, faintly, what surfaces hide, then what lies before them; in any order,
// since all of a kind have one colour. Owns its programs and the records.

#include <span>

#include "sim_cuda/publish/publish.h"
#include "viewer/render/gl/buffer.h"
#include "viewer/render/gl/program.h"
#include "viewer/render/gl/vertex_layout.h"

namespace collidoscope {

class GhostPass {
 public:
  GhostPass();
  void set(std::span<const GhostInstance> ghosts);
  /// Into the bound framebuffer, whose depth is that of the surfaces; blends, and leaves depth as it is.
  void draw_ghosts() const;
  /// Each `magnification` times as long as the error.
  void draw_errors(double magnification) const;

 private:
  void draw(const gl::Program& program, GLsizei vertices, float hidden) const;

  gl::Program ghost_, error_;
  gl::VertexLayout nothing_;
  gl::Buffer records_{"ghosts"};
  std::int64_t count_ = 0;
};

}  // namespace collidoscope

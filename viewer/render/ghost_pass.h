#pragma once
// Draws the reference positions: ghosts as translucent spheres with bright outline, and error vectors from
// bodies to ghosts. Parts behind surfaces are drawn first and faint, then visible parts. The order is
// irrelevant, since each kind has one colour. Owns its programs and records.

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
  /// Draws into the bound framebuffer with the depth of the surfaces. Blends; does not write depth.
  void draw_ghosts() const;
  /// Draws each vector `magnification` times as long as the error.
  void draw_errors(double magnification) const;

 private:
  void draw(const gl::Program& program, GLsizei vertices, float hidden) const;

  gl::Program ghost_, error_;
  gl::VertexLayout nothing_;
  gl::Buffer records_{"ghosts"};
  std::int64_t count_ = 0;
};

}  // namespace collidoscope

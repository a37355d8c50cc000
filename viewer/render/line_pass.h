#pragma once
// Draws what consists of lines: the hierarchy's boxes, contacts, and the edges of the walls. First what lies
// before the surfaces, then, faintly, what they hide. Owns its programs.

#include "viewer/render/gl/program.h"
#include "viewer/render/gl/vertex_layout.h"
#include "viewer/render/instance_buffers.h"

namespace collidoscope {

class LinePass {
 public:
  LinePass();
  /// Into the bound framebuffer, whose depth is that of the surfaces; blends, and leaves depth as it is.
  /// The boxes hold levels first_level to last_level, in this order.
  void draw_boxes(const gl::Buffer& boxes, std::int64_t count, int first_level, int last_level) const;
  void draw_walls(const gl::Buffer& boxes) const;  ///< one box
  void draw_contacts(const gl::Buffer& contacts, std::int64_t count) const;
  /// Into an id buffer: faces filled, 0x80000000 + place of the box in the buffer, nearest wins.
  void draw_box_ids(const gl::Buffer& boxes, std::int64_t count) const;

 private:
  void bind_boxes(const gl::Buffer& boxes, std::int64_t count) const;
  void draw_twice(const gl::Program& program, GLsizei vertices, std::int64_t count, float shown,
                  float hidden) const;

  gl::Program box_, contact_, box_ids_;
  gl::VertexLayout nothing_, box_layout_, contact_layout_;
};

}  // namespace collidoscope

#include "viewer/render/line_pass.h"

#include <algorithm>
#include <cstddef>

#include "viewer/render/gl/errors.h"

namespace collidoscope {

LinePass::LinePass()
    : box_("box.vert", "line.frag"),
      contact_("contact.vert", "contact.frag"),
      box_ids_("box.vert", "id.frag", "#define IDS\n"),
      nothing_{},
      box_layout_{{0, 4, offsetof(BoxInstance, min)}, {1, 4, offsetof(BoxInstance, max)}},
      contact_layout_{{0, 4, offsetof(ContactInstance, point)},
                      {1, 4, offsetof(ContactInstance, normal)},
                      {2, 1, offsetof(ContactInstance, radius)}} {}

void LinePass::draw_twice(const gl::Program& program, GLsizei vertices, std::int64_t count, float shown,
                          float hidden) const {
  program.use();
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_FALSE);
  // Depth is reversed: less is farther.
  glDepthFunc(GL_LESS);
  program.set("strength", hidden);
  glDrawArraysInstanced(GL_TRIANGLES, 0, vertices, static_cast<GLsizei>(count));
  glDepthFunc(GL_GEQUAL);
  program.set("strength", shown);
  glDrawArraysInstanced(GL_TRIANGLES, 0, vertices, static_cast<GLsizei>(count));
}

void LinePass::bind_boxes(const gl::Buffer& boxes, std::int64_t count) const {
  nothing_.bind(0, 0);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, boxes.get());
  box_.set("box_count", static_cast<int>(count));
}

void LinePass::draw_boxes(const gl::Buffer& boxes, std::int64_t count, int first_level,
                          int last_level) const {
  if (count <= 0) return;
  bind_boxes(boxes, count);
  box_.set("levels", static_cast<float>(first_level), static_cast<float>(last_level), 0, 0);
  draw_twice(box_, 72, count, 0.95f, std::min(0.2f, 5.0f / static_cast<float>(count)));
  gl::check("to draw " + std::to_string(count) + " boxes");
}

void LinePass::draw_walls(const gl::Buffer& boxes) const {
  bind_boxes(boxes, 1);
  box_.set("levels", 0, 0, 0, 0);
  draw_twice(box_, 72, 1, 0.30f, 0.06f);
  gl::check("to draw the walls");
}

void LinePass::draw_contacts(const gl::Buffer& contacts, std::int64_t count) const {
  if (count <= 0) return;
  contact_layout_.bind(contacts.get(), sizeof(ContactInstance));
  // What is hidden adds up to a fog where there are many, so each is the fainter then.
  draw_twice(contact_, 12, count, 1.0f, std::min(0.3f, 70.0f / static_cast<float>(count)));
  gl::check("to draw " + std::to_string(count) + " contacts");
}

void LinePass::draw_box_ids(const gl::Buffer& boxes, std::int64_t count) const {
  if (count <= 0) return;
  box_layout_.bind(boxes.get(), sizeof(BoxInstance));
  box_ids_.use();
  glDrawArraysInstanced(GL_TRIANGLES, 0, 36, static_cast<GLsizei>(count));
  gl::check("to draw the ids of " + std::to_string(count) + " boxes");
}

}  // namespace collidoscope

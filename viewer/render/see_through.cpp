#include "viewer/render/see_through.h"

namespace collidoscope {

void begin_see_through(const gl::Program& program, const gl::VertexLayout& nothing) {
  program.use();
  nothing.bind(0, 0);
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_FALSE);
}

void draw_see_through(const gl::Program& program, const gl::VertexLayout& nothing, GLenum mode,
                      GLsizei vertices, const Records& records, float shown, float hidden, bool backwards) {
  if (records.count <= 0) return;
  begin_see_through(program, nothing);
  const auto draw = [&](GLenum test, float strength) {
    glDepthFunc(test);
    program.set("strength", strength);
    records.in_blocks([&](int first, int count) {
      program.set("first", first);
      if (backwards) program.set("count", count);
      glDrawArrays(mode, 0, static_cast<GLsizei>(count) * vertices);
    });
  };
  // Reversed depth: less is farther.
  if (hidden >= min_visible_opacity) draw(GL_LESS, hidden);
  draw(GL_GEQUAL, shown);
}

}  // namespace collidoscope

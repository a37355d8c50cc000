#include "viewer/render/ghost_pass.h"

#include <algorithm>
#include <string>

#include "viewer/render/colors.h"
#include "viewer/render/gl/errors.h"

namespace collidoscope {

GhostPass::GhostPass() : ghost_("ghost.vert", "ghost.frag"), error_("error.vert", "line.frag"), nothing_{} {
  ghost_.set("tint", ghost_color.r, ghost_color.g, ghost_color.b, 1);
  error_.set("tint", error_color.r, error_color.g, error_color.b, 1);
}

void GhostPass::set(std::span<const GhostInstance> ghosts) {
  count_ = static_cast<std::int64_t>(ghosts.size());
  if (count_ > 0) records_.upload(ghosts.data(), ghosts.size_bytes());
}

void GhostPass::draw_twice(const gl::Program& program, int vertices, float hidden) const {
  program.use();
  nothing_.bind(0, 0);
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_FALSE);
  // Depth is reversed: less is farther.
  for (const auto& [test, strength] : {std::pair{GL_LESS, hidden}, {GL_GEQUAL, 1.0f}}) {
    glDepthFunc(test);
    program.set("strength", strength);
    constexpr std::int64_t block = 1 << 20;  // shaders reach a limited part of a buffer at once
    for (std::int64_t first = 0; first < count_; first += block) {
      const std::int64_t count = std::min(block, count_ - first);
      constexpr std::int64_t bytes = sizeof(GhostInstance);
      glBindBufferRange(GL_SHADER_STORAGE_BUFFER, 0, records_.get(), first * bytes, count * bytes);
      glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(count) * vertices);
    }
  }
  gl::check("to draw " + std::to_string(count_) + " ghosts");
}

void GhostPass::draw_ghosts() const {
  // Many that are hidden add up to a fog.
  if (count_ > 0) draw_twice(ghost_, 6, std::min(0.3f, 30.0f / static_cast<float>(count_)));
}

void GhostPass::draw_errors(double magnification) const {
  if (count_ == 0) return;
  error_.set("magnification", static_cast<float>(magnification));
  // A short one lies within its body, and is what somebody looks for all the same.
  draw_twice(error_, 18, std::clamp(600.0f / static_cast<float>(count_), 0.25f, 0.75f));
}

}  // namespace collidoscope

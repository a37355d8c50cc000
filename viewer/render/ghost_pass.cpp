#include "viewer/render/ghost_pass.h"

#include <algorithm>
#include <string>

#include "viewer/render/colors.h"
#include "viewer/render/gl/errors.h"
#include "viewer/render/see_through.h"

namespace collidoscope {

GhostPass::GhostPass() : ghost_("ghost.vert", "ghost.frag"), error_("error.vert", "line.frag"), nothing_{} {
  ghost_.set("tint", ghost_color.r, ghost_color.g, ghost_color.b, 1);
  error_.set("tint", error_color.r, error_color.g, error_color.b, 1);
}

void GhostPass::set(std::span<const GhostInstance> ghosts) {
  count_ = static_cast<std::int64_t>(ghosts.size());
  if (count_ > 0) records_.upload(ghosts.data(), ghosts.size_bytes());
}

void GhostPass::draw(const gl::Program& program, GLsizei vertices, float hidden) const {
  draw_see_through(program, nothing_, GL_TRIANGLES, vertices, {records_, sizeof(GhostInstance), 0, count_},
                   1.0f, hidden);
  gl::check("draw " + std::to_string(count_) + " ghosts");
}

void GhostPass::draw_ghosts() const {
  // Hidden ghosts are fainter if there are many, to limit the overdraw.
  if (count_ > 0) draw(ghost_, 6, std::min(0.3f, 30.0f / static_cast<float>(count_)));
}

void GhostPass::draw_errors(double magnification) const {
  if (count_ == 0) return;
  error_.set("magnification", static_cast<float>(magnification));
  // Short vectors lie within their body. They are drawn nevertheless, since they are the information sought.
  draw(error_, 18, std::clamp(600.0f / static_cast<float>(count_), 0.25f, 0.75f));
}

}  // namespace collidoscope

#include "viewer/render/line_pass.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "viewer/render/frame_uniforms.h"
#include "viewer/render/gl/errors.h"
#include "viewer/render/see_through.h"

namespace collidoscope {

LinePass::LinePass()
    : box_("box.vert", "line.frag"),
      thin_box_("box.vert", "line.frag", "#define THIN\n"),
      contact_("contact.vert", "contact.frag"),
      listed_contact_("contact.vert", "contact.frag", "#define LISTED\n"),
      joint_("joint.vert", "contact.frag"),
      box_ids_("box.vert", "id.frag", "#define IDS\n"),
      edge_ids_("box.vert", "id.frag", "#define IDS\n#define EDGES\n"),
      nothing_{},
      box_layout_{{0, 4, offsetof(BoxInstance, min)}, {1, 4, offsetof(BoxInstance, max)}} {}

void LinePass::look_at(const gl::Target& surfaces, bool cull) { cull_.look_at(surfaces, cull); }

void LinePass::draw_listed(const gl::Program& program, LineCull::Kind kind, GLenum mode, GLsizei vertices,
                           const Records& records, float strength, float low, float high) {
  records.in_blocks([&](int first, int count) {
    cull_.list(kind, first, count, vertices, low, high);
    program.set("first", first);
    program.set("strength", strength);
    begin_see_through(program, nothing_);
    glDepthFunc(GL_GEQUAL);
    glDrawArraysIndirect(mode, nullptr);
  });
}

void LinePass::draw_broad(const gl::Buffer& boxes, std::int64_t count, float shown, float hidden) const {
  draw_see_through(box_, nothing_, GL_TRIANGLES, 72, {boxes, sizeof(BoxInstance), 0, count}, shown, hidden,
                   true);
}

void LinePass::set_colors(const gl::Program& program, const BoxColors& colors) {
  const bool logarithmic = is_logarithmic(colors.metric);
  const ColorScale scale = color_scale(colors.min, colors.max, logarithmic);
  const float kind = colors.metric == NodeMetric::level ? 0 : logarithmic ? 2 : 1;
  const float widest =
      std::clamp(15 / std::sqrt(static_cast<float>(std::max<std::int64_t>(colors.count, 1))), 0.7f, 1.5f);
  program.set("coloring", static_cast<float>(scale.from), static_cast<float>(scale.scale), kind, widest);
}

void LinePass::draw_boxes(const gl::Buffer& boxes, std::span<const std::int64_t> sizes, int first_level,
                          int last_level, const BoxColors& colors, int highlighted_level) {
  const std::int64_t count = std::accumulate(sizes.begin(), sizes.end(), std::int64_t{0});
  std::int64_t broad = 0;
  for (std::int64_t size : sizes) {
    if (broad + size > max_broad_boxes) break;
    broad += size;
  }
  // Hidden lines are fainter if there are many, to limit the overdraw.
  const float hidden = std::min(0.2f, 5.0f / static_cast<float>(std::max<std::int64_t>(count, 1)));
  for (const gl::Program* program : {&box_, &thin_box_}) {
    program->set("levels", static_cast<float>(first_level), static_cast<float>(last_level),
                 static_cast<float>(highlighted_level), 0);
    program->set("range", static_cast<float>(colors.low), static_cast<float>(colors.high), 0, 0);
    set_colors(*program, colors);
  }
  // Above this count hidden boxes are not drawn: only potentially visible ones are.
  if (count > broad)
    draw_listed(thin_box_, LineCull::Kind::boxes, GL_LINES, 24,
                {boxes, sizeof(BoxInstance), broad, count - broad}, 0.95f, static_cast<float>(colors.low),
                static_cast<float>(colors.high));
  draw_broad(boxes, broad, 0.95f, hidden);
  gl::check("draw " + std::to_string(count) + " boxes");
}

void LinePass::draw_marks(const gl::Buffer& boxes, std::int64_t count) const {
  box_.set("levels", 0, 0, -1, 0);
  box_.set("range", 0, box_marks, 0, 0);
  box_.set("coloring", 0, 0, 3, 0);
  // Contacts are drawn through surfaces, unless there are many.
  const float hidden = std::min(0.45f, 20.0f / static_cast<float>(std::max<std::int64_t>(count, 1)));
  draw_broad(boxes, count, 0.95f, hidden);
  gl::check("draw " + std::to_string(count) + " marks");
}

void LinePass::draw_walls(const gl::Buffer& boxes) const {
  box_.set("levels", 0, 0, -1, 0);
  box_.set("range", -1, 1, 0, 0);
  box_.set("coloring", 0, 0, 4, 0);
  draw_broad(boxes, 1, 0.30f, 0.06f);
  gl::check("draw the walls");
}

void LinePass::draw_contacts(const gl::Buffer& contacts, std::int64_t count) {
  const float hidden = std::min(0.3f, 70.0f / static_cast<float>(std::max<std::int64_t>(count, 1)));
  const Records records{contacts, sizeof(ContactInstance), 0, count};
  if (hidden < min_visible_opacity && count > 0)
    draw_listed(listed_contact_, LineCull::Kind::contacts, GL_TRIANGLES, 12, records, 1.0f);
  else
    draw_see_through(contact_, nothing_, GL_TRIANGLES, 12, records, 1.0f, hidden);
  gl::check("draw " + std::to_string(count) + " contacts");
}

void LinePass::draw_joints(const gl::Buffer& joints, std::int64_t count) const {
  const float hidden = std::min(0.25f, 100.0f / static_cast<float>(std::max<std::int64_t>(count, 1)));
  draw_see_through(joint_, nothing_, GL_TRIANGLES, 132, {joints, sizeof(JointInstance), 0, count}, 1.0f,
                   hidden);
  gl::check("draw " + std::to_string(count) + " joints");
}

void LinePass::draw_box_ids(const gl::Buffer& boxes, std::int64_t count, bool edges, double low,
                            double high) const {
  if (count <= 0) return;
  const gl::Program& program = edges ? edge_ids_ : box_ids_;
  program.set("range", static_cast<float>(low), static_cast<float>(high), 0, 0);
  box_layout_.bind(boxes.get(), sizeof(BoxInstance));
  program.use();
  glDrawArraysInstanced(edges ? GL_LINES : GL_TRIANGLES, 0, edges ? 24 : 36, static_cast<GLsizei>(count));
  gl::check("draw the ids of " + std::to_string(count) + " boxes");
}

}  // namespace collidoscope

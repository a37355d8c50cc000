#pragma once
// Draws what consists of lines: the hierarchy's boxes, contacts, joints, and the edges of the walls. First,
// faintly, what surfaces hide, then what lies before them. Many boxes are drawn in thin lines: a fog of broad
// ones shows nothing, and a GPU with few raster units takes long over it. Owns its programs.

#include <limits>
#include <span>

#include "viewer/render/gl/program.h"
#include "viewer/render/gl/vertex_layout.h"
#include "viewer/render/instance_buffers.h"
#include "viewer/render/line_cull.h"
#include "viewer/render/see_through.h"

namespace collidoscope {

/// What of BoxInstance::value is drawn, and in which colours.
struct BoxColors {
  NodeMetric metric = NodeMetric::level;
  double min = 0, max = 1;  ///< that the colour map spans
  /// Boxes whose value lies outside are not drawn: none of a metric that they do not have.
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  std::int64_t count = 0;  ///< of those: the fewer, the broader
};

class LinePass {
 public:
  LinePass();
  /// Before the others, in each frame: the surfaces whose depth hides lines. `cull`: whether lines that they
  /// hide are left out before they are drawn (line_cull.h); the picture is the same.
  void look_at(const gl::Target& surfaces, bool cull);
  /// Into the bound framebuffer, whose depth is that of the surfaces; blends, and leaves depth as it is.
  /// The records are those of levels first_level to last_level, in this order, `sizes[i]` of each. Upper
  /// levels are broad as long as they have no more than `max_broad_boxes` together.
  /// The colour map of values is bound to texture unit 0. Of `highlighted_level` all others are faint.
  void draw_boxes(const gl::Buffer& boxes, std::span<const std::int64_t> sizes, int first_level,
                  int last_level, const BoxColors& colors = {}, int highlighted_level = -1);
  /// Boxes whose value is a BoxMark; those that come first lie on top.
  void draw_marks(const gl::Buffer& boxes, std::int64_t count) const;
  void draw_walls(const gl::Buffer& boxes) const;  ///< one box
  void draw_contacts(const gl::Buffer& contacts, std::int64_t count);
  void draw_joints(const gl::Buffer& joints, std::int64_t count) const;
  /// Into an id buffer: faces filled or edges one pixel wide, 0x80000000 + place of the box in the buffer,
  /// nearest wins; of boxes whose value lies from `low` to `high`.
  void draw_box_ids(const gl::Buffer& boxes, std::int64_t count, bool edges, double low, double high) const;

  static constexpr std::int64_t max_broad_boxes = 8192;

 private:
  void draw_broad(const gl::Buffer& boxes, std::int64_t count, float shown, float hidden) const;
  static void set_colors(const gl::Program& program, const BoxColors& colors);
  /// What may be seen of them.
  void draw_listed(const gl::Program& program, LineCull::Kind kind, GLenum mode, GLsizei vertices,
                   const Records& records, float strength, float low = 0, float high = 0);

  gl::Program box_, thin_box_, contact_, listed_contact_, joint_, box_ids_, edge_ids_;
  LineCull cull_;
  gl::VertexLayout nothing_, box_layout_;
};

}  // namespace collidoscope

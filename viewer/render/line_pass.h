#pragma once
// Draws lines: boxes of the tree, contacts, joints, and edges of the walls. Parts behind surfaces are drawn
// first and faint, then visible parts. Many boxes are drawn with thin lines: wide lines would hide each
// other, and are slow on GPUs with few raster units. Owns its programs.

#include <limits>
#include <span>

#include "viewer/render/gl/program.h"
#include "viewer/render/gl/vertex_layout.h"
#include "viewer/render/instance_buffers.h"
#include "viewer/render/line_cull.h"
#include "viewer/render/see_through.h"

namespace collidoscope {

/// Range of the drawn BoxInstance::value and its colours.
struct BoxColors {
  NodeMetric metric = NodeMetric::level;
  double min = 0, max = 1;  ///< range of the colour map
  /// Boxes with values outside are not drawn, including boxes without a value of this metric.
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  std::int64_t count = 0;  ///< number of drawn boxes; fewer boxes have wider lines
};

class LinePass {
 public:
  LinePass();
  /// Sets the surfaces whose depth hides lines. Call first in each frame. `cull`: cull hidden lines
  /// (line_cull.h), which does not change the picture.
  void look_at(const gl::Target& surfaces, bool cull);
  /// Draws into the bound framebuffer with the depth of the surfaces. Blends; does not write depth. The
  /// records are ordered by level, from first_level to last_level, with `sizes[i]` per level. Upper levels
  /// have wide lines, up to `max_broad_boxes` boxes in total. The colour map of values must be bound to
  /// texture unit 0. If `highlighted_level` is set, all other levels are faint.
  void draw_boxes(const gl::Buffer& boxes, std::span<const std::int64_t> sizes, int first_level,
                  int last_level, const BoxColors& colors = {}, int highlighted_level = -1);
  /// Boxes with a BoxMark as value. Earlier records are drawn on top.
  void draw_marks(const gl::Buffer& boxes, std::int64_t count) const;
  void draw_walls(const gl::Buffer& boxes) const;  ///< draws one box
  void draw_contacts(const gl::Buffer& contacts, std::int64_t count);
  void draw_joints(const gl::Buffer& joints, std::int64_t count) const;
  /// Draws faces, or edges one pixel wide, into an id buffer: 0x80000000 + index of the box, nearest first.
  /// Only boxes with values from `low` to `high`.
  void draw_box_ids(const gl::Buffer& boxes, std::int64_t count, bool edges, double low, double high) const;

  static constexpr std::int64_t max_broad_boxes = 8192;

 private:
  void draw_broad(const gl::Buffer& boxes, std::int64_t count, float shown, float hidden) const;
  static void set_colors(const gl::Program& program, const BoxColors& colors);
  /// Draws the potentially visible records.
  void draw_listed(const gl::Program& program, LineCull::Kind kind, GLenum mode, GLsizei vertices,
                   const Records& records, float strength, float low = 0, float high = 0);

  gl::Program box_, thin_box_, contact_, listed_contact_, joint_, box_ids_, edge_ids_;
  LineCull cull_;
  gl::VertexLayout nothing_, box_layout_;
};

}  // namespace collidoscope

#pragma once
// Culls invisible lines on the GPU: records outside the picture, or behind the farthest depth of all tiles
// that they touch. The picture does not change. In a box full of bodies, nine in ten of the tree's boxes are
// hidden. Owns its programs and lists.

#include <optional>

#include "viewer/render/gl/buffer.h"
#include "viewer/render/gl/program.h"
#include "viewer/render/gl/target.h"

namespace collidoscope {

class LineCull {
 public:
  LineCull();

  /// Depth of the surfaces of this frame. `cull` false: no culling. Changes the bindings of texture unit 0
  /// and image unit 0.
  void look_at(const gl::Target& surfaces, bool cull);

  enum class Kind { boxes, contacts };
  /// Lists the visible ones of `count` records of the buffer at storage binding 0, starting at `first`. Binds
  /// the list to binding 3 and to GL_DRAW_INDIRECT_BUFFER. Changes the binding of texture unit 1. `low`,
  /// `high`: value range of the boxes.
  void list(Kind kind, int first, int count, int vertices_each, float low = 0, float high = 0);

 private:
  gl::Program tiles_, mark_boxes_, mark_contacts_, sum_, list_;
  gl::TextureHandle depths_;
  int width_ = 0, height_ = 0;  ///< in tiles
  bool culling_ = true;
  gl::Buffer ranks_, starts_, listed_;
};

}  // namespace collidoscope

#pragma once
// Leaves out lines that nobody can see, on the GPU: what lies outside of the picture, or behind the farthest
// depth of every tile that it touches. The picture is the same without it; where bodies fill a box, nine in
// ten of the hierarchy's boxes are behind others. Owns its programs and the lists it makes.

#include <optional>

#include "viewer/render/gl/buffer.h"
#include "viewer/render/gl/program.h"
#include "viewer/render/gl/target.h"

namespace collidoscope {

class LineCull {
 public:
  LineCull();

  /// The depth of the surfaces of this frame; `cull` false: everything may be seen. Changes what texture unit
  /// 0 and image unit 0 hold.
  void look_at(const gl::Target& surfaces, bool cull);

  enum class Kind { boxes, contacts };
  /// Lists which of `count` records may be seen, from `first` on of the buffer bound to storage binding 0,
  /// and binds the list to binding 3 and to GL_DRAW_INDIRECT_BUFFER. Changes what texture unit 1 holds.
  /// `low`, `high`: values of boxes drawn.
  void list(Kind kind, int first, int count, int vertices_each, float low = 0, float high = 0);

 private:
  gl::Program tiles_, mark_boxes_, mark_contacts_, sum_, list_;
  gl::TextureHandle depths_;
  int width_ = 0, height_ = 0;  ///< tiles
  bool culling_ = true;
  gl::Buffer ranks_, starts_, listed_;
};

}  // namespace collidoscope

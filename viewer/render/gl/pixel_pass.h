#pragma once
// A shader that computes each pixel of a picture (shade() of frame.glsl), as a fragment or a compute shader.
// Both give the same picture. Data-centre GPUs have few raster units, so compute shaders are faster there.

#include <string>

#include "viewer/render/gl/program.h"
#include "viewer/render/gl/target.h"
#include "viewer/render/gl/vertex_layout.h"

namespace collidoscope::gl {

class PixelPass {
 public:
  /// `format`: of the picture, GL_RGBA8 or GL_R16F.
  PixelPass(const std::string& file, bool compute, GLenum format, const std::string& definitions = "");
  /// Writes all pixels of the first colour texture of `target`. As a fragment shader, the depth test applies.
  /// Precondition: the textures that the shader reads are bound.
  void draw(const Target& target) const;

 private:
  bool compute_;
  GLenum format_;
  Program program_;
  VertexLayout nothing_;
};

}  // namespace collidoscope::gl

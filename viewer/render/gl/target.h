#pragma once
// Textures that are drawn into, and the framebuffer that holds them. A Target owns its textures and is made
// anew when the size changes.

#include <string>
#include <vector>

#include "viewer/render/gl/handle.h"

namespace collidoscope::gl {

class Target {
 public:
  /// `formats`: sized internal formats of the colour textures (GL_RGBA8...) in the order of the fragment
  /// shader's outputs; `depth`: 0, or a depth format.
  Target(const std::string& name, int width, int height, const std::vector<GLenum>& formats, GLenum depth);

  void bind() const;  ///< for drawing, with the viewport on all of it
  GLuint framebuffer() const { return framebuffer_.get(); }
  GLuint color(std::size_t i = 0) const { return colors_.at(i).get(); }
  GLuint depth() const { return depth_.get(); }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  int width_, height_;
  std::vector<TextureHandle> colors_;
  TextureHandle depth_;
  FramebufferHandle framebuffer_;
};

/// Pixels: the largest width and height of a target that OpenGL allows here.
int largest_target();

/// A 2D texture with storage for one level, unfiltered and clamped.
TextureHandle make_texture(const std::string& name, int width, int height, GLenum format);

}  // namespace collidoscope::gl

#pragma once
// A framebuffer with its textures. Owns the textures; make a new Target if the size changes.

#include <string>
#include <vector>

#include "viewer/render/gl/handle.h"

namespace collidoscope::gl {

class Target {
 public:
  /// `formats`: sized internal formats of the colour textures (GL_RGBA8 ...), ordered as the fragment
  /// outputs. `depth`: depth format, or 0.
  Target(const std::string& name, int width, int height, const std::vector<GLenum>& formats, GLenum depth);

  void bind() const;  ///< binds it for drawing and sets the viewport
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

/// Pixels, maximum width and height of a target.
int largest_target();

/// A 2D texture with storage for one level, nearest filtering and clamping.
TextureHandle make_texture(const std::string& name, int width, int height, GLenum format);

}  // namespace collidoscope::gl

#include "viewer/render/gl/target.h"

#include <algorithm>

#include "sim_cuda/core/error.h"
#include "viewer/render/gl/errors.h"

namespace collidoscope::gl {

TextureHandle make_texture(const std::string& name, int width, int height, GLenum format) {
  GLuint texture = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &texture);
  TextureHandle handle(texture);
  glTextureStorage2D(texture, 1, format, width, height);
  glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  check("create a texture of " + std::to_string(width) + "x" + std::to_string(height) + " for '" + name +
        "'");
  return handle;
}

int largest_target() {
  GLint texture = 0, viewport[2] = {};
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &texture);
  glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
  return std::min({texture, viewport[0], viewport[1]});
}

Target::Target(const std::string& name, int width, int height, const std::vector<GLenum>& formats,
               GLenum depth)
    : width_(width), height_(height) {
  GLuint framebuffer = 0;
  glCreateFramebuffers(1, &framebuffer);
  framebuffer_ = FramebufferHandle(framebuffer);
  std::vector<GLenum> outputs;
  for (GLenum format : formats) {
    colors_.push_back(make_texture(name, width, height, format));
    outputs.push_back(static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + outputs.size()));
    glNamedFramebufferTexture(framebuffer, outputs.back(), colors_.back().get(), 0);
  }
  glNamedFramebufferDrawBuffers(framebuffer, static_cast<GLsizei>(outputs.size()), outputs.data());
  if (depth) {
    depth_ = make_texture(name, width, height, depth);
    glNamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, depth_.get(), 0);
  }
  const GLenum status = glCheckNamedFramebufferStatus(framebuffer, GL_DRAW_FRAMEBUFFER);
  check("create the framebuffer '" + name + "'");
  if (status != GL_FRAMEBUFFER_COMPLETE)
    throw MachineError("OpenGL: cannot create the framebuffer '" + name + "' of " + std::to_string(width) +
                       "x" + std::to_string(height) + ": status " + std::to_string(status));
}

void Target::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.get());
  glViewport(0, 0, width_, height_);
}

}  // namespace collidoscope::gl

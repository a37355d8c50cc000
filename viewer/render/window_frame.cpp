#include "viewer/render/window_frame.h"

#include <algorithm>

#include "viewer/render/gl/errors.h"

namespace collidoscope {

WindowFrame::WindowFrame(int width, int height) : target_("window", width, height, {GL_RGBA8}, 0) {}

void WindowFrame::resize(int width, int height) {
  if (width == this->width() && height == this->height()) return;
  target_ = gl::Target("window", width, height, {GL_RGBA8}, 0);
}

void WindowFrame::place(const Renderer& renderer, int x, int y, int width, int height) const {
  glDisable(GL_SCISSOR_TEST);
  const int bottom = this->height() - y - height;
  const gl::Target& picture = renderer.picture();
  const bool same = picture.width() == width && picture.height() == height;
  glBlitNamedFramebuffer(picture.framebuffer(), target_.framebuffer(), 0, 0, picture.width(),
                         picture.height(), x, bottom, x + width, bottom + height, GL_COLOR_BUFFER_BIT,
                         same ? GL_NEAREST : GL_LINEAR);
  gl::check("copy the 3D view to the window");
}

Image WindowFrame::read() const {
  Image image{width(), height(), {}};
  const std::size_t row = static_cast<std::size_t>(width()) * 4;
  image.rgba.resize(row * static_cast<std::size_t>(height()));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glGetTextureImage(target_.color(), 0, GL_RGBA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(image.rgba.size()),
                    image.rgba.data());
  gl::check("read the pixels of the window");
  const auto begin = image.rgba.begin();
  for (int y = 0; y < height() / 2; ++y)  // OpenGL returns rows from the bottom
    std::swap_ranges(begin + static_cast<std::ptrdiff_t>(row) * y,
                     begin + static_cast<std::ptrdiff_t>(row) * (y + 1),
                     begin + static_cast<std::ptrdiff_t>(row) * (height() - 1 - y));
  return image;
}

void WindowFrame::present(int width, int height) const {
  glDisable(GL_SCISSOR_TEST);
  // Software renderers adopt a new window size when its framebuffer is bound.
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, width, height);
  glClearColor(0, 0, 0, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  // Rows start at the bottom: align the top left corners if the sizes differ.
  glBlitNamedFramebuffer(target_.framebuffer(), 0, 0, 0, this->width(), this->height(), 0,
                         height - this->height(), this->width(), height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  gl::check("present the window");
}

}  // namespace collidoscope

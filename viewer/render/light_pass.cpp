#include "viewer/render/light_pass.h"

#include "viewer/render/gl/errors.h"

namespace collidoscope {

LightPass::LightPass(Quality quality, bool compute)
    : quick_(quality == Quality::quick),
      occlusion_("occlusion.frag", compute, GL_R16F),
      blur_("occlusion_blur.frag", compute, GL_R16F),
      lighting_("lighting.frag", compute, GL_RGBA8, quick_ ? "#define QUICK\n" : ""),
      shadow_("shadow map", quick_ ? 768 : 2048, quick_ ? 768 : 2048, {}, GL_DEPTH_COMPONENT32F) {
  const GLuint map = shadow_.depth();
  glTextureParameteri(map, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTextureParameteri(map, GL_TEXTURE_COMPARE_FUNC, GL_GEQUAL);  // reversed depth
  const GLint filter = quick_ ? GL_NEAREST : GL_LINEAR;
  glTextureParameteri(map, GL_TEXTURE_MIN_FILTER, filter);
  glTextureParameteri(map, GL_TEXTURE_MAG_FILTER, filter);
  if (!compute)
    backdrop_.emplace("lighting.frag", false, GL_RGBA8,
                      quick_ ? "#define BACKDROP\n#define QUICK\n" : "#define BACKDROP\n");
}

void LightPass::resize(int width, int height) {
  if (rough_ && rough_->width() == width && rough_->height() == height) return;
  rough_.emplace("occlusion", width, height, std::vector<GLenum>{GL_R16F}, 0);
  smooth_.emplace("smooth occlusion", width, height, std::vector<GLenum>{GL_R16F}, 0);
}

const gl::Target& LightPass::begin_shadows(bool clear) const {
  shadow_.bind();
  glDepthMask(GL_TRUE);
  const float farthest = 0;
  if (clear) glClearNamedFramebufferfv(shadow_.framebuffer(), GL_DEPTH, 0, &farthest);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  gl::check("clear the shadow map");
  return shadow_;
}

void LightPass::draw(const gl::Target& surface, const gl::Target& lit) const {
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
  glDepthMask(GL_FALSE);
  if (quick_) {
    const float all_open[4] = {1, 1, 1, 1};
    glClearNamedFramebufferfv(smooth_->framebuffer(), GL_COLOR, 0, all_open);
  } else {
    glBindTextureUnit(0, surface.depth());
    glBindTextureUnit(1, surface.color(1));
    occlusion_.draw(*rough_);
    glBindTextureUnit(0, rough_->color());
    glBindTextureUnit(1, surface.depth());
    blur_.draw(*smooth_);
  }

  // A triangle at the far depth 0, which matches the depth of background pixels.
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_EQUAL);
  if (backdrop_) backdrop_->draw(lit);
  glDepthFunc(GL_LESS);
  glBindTextureUnit(0, surface.color(0));
  glBindTextureUnit(1, surface.color(1));
  glBindTextureUnit(2, surface.depth());
  glBindTextureUnit(3, smooth_->color());
  glBindTextureUnit(4, shadow_.depth());
  lighting_.draw(lit);
  gl::check("draw the lighting");
}

}  // namespace collidoscope

#include "viewer/render/gl/pixel_pass.h"

namespace collidoscope::gl {
namespace {

constexpr int group_side = 8;  // pixels; as in frame.glsl

Program program_of(const std::string& file, bool compute, GLenum format, const std::string& definitions) {
  const std::string each_pixel = "#define EACH_PIXEL\n" + definitions;
  if (!compute) return Program("fullscreen.vert", file, each_pixel);
  const char* name = format == GL_R16F ? "r16f" : "rgba8";
  return Program::compute(file, each_pixel + "#define COMPUTED_FORMAT " + name + "\n");
}

}  // namespace

PixelPass::PixelPass(const std::string& file, bool compute, GLenum format, const std::string& definitions)
    : compute_(compute),
      format_(format),
      program_(program_of(file, compute, format, definitions)),
      nothing_{} {}

void PixelPass::draw(const Target& target) const {
  program_.use();
  if (!compute_) {
    target.bind();
    nothing_.bind(0, 0);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    return;
  }
  glBindImageTexture(0, target.color(), 0, GL_FALSE, 0, GL_WRITE_ONLY, format_);
  const auto groups = [](int pixels) { return static_cast<GLuint>((pixels + group_side - 1) / group_side); };
  glDispatchCompute(groups(target.width()), groups(target.height()), 1);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
}

}  // namespace collidoscope::gl

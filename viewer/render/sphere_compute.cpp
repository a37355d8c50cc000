#include "viewer/render/sphere_compute.h"

#include <algorithm>

#include "viewer/render/gl/errors.h"

namespace collidoscope {

SphereCompute::SphereCompute()
    : small_(gl::Program::compute("sphere.comp")),
      large_(gl::Program::compute("sphere.comp", "#define LARGE\n")),
      merge_surface_("fullscreen.vert", "sphere_merge.frag", "#define SURFACE\n"),
      merge_shadow_("fullscreen.vert", "sphere_merge.frag", "#define SHADOW\n"),
      nothing_{} {
  GLint64 most = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
  max_bytes_ = most;
}

bool SphereCompute::fits(std::int64_t bodies) const {
  return bodies * static_cast<std::int64_t>(sizeof(BodyInstance)) <= max_bytes_;
}

void SphereCompute::dispatch(std::int64_t bodies, bool second_round) const {
  constexpr std::int64_t lanes = 128, most_groups = 65535;
  // Workgroups: enough to fill a large GPU, few enough that an empty list has negligible cost.
  constexpr GLuint large_groups = 1024, huge_columns = 32, huge_rows = 64;
  for (const gl::Program* program : {&small_, &large_}) {
    program->set("body_count", static_cast<int>(bodies));
    program->set("second_round", second_round ? 1 : 0);
  }
  small_.use();
  glDispatchCompute(static_cast<GLuint>(std::min((bodies + lanes - 1) / lanes, most_groups)), 1, 1);
  if (!second_round) glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);  // barrier for the list
  large_.use();
  large_.set("huge", 0);
  glDispatchCompute(large_groups, 1, 1);
  large_.set("huge", 1);
  glDispatchCompute(huge_columns, huge_rows, 1);
}

void SphereCompute::draw(const InstanceBuffers& instances, bool shadow, GLuint colors,
                         const gl::Target& target) {
  Images& images = shadow ? shadow_ : surface_;
  if (images.width != target.width() || images.height != target.height()) {
    images.nearest = gl::make_texture("nearest depth", target.width(), target.height(), GL_R32UI);
    if (!shadow) images.owners = gl::make_texture("pixel bodies", target.width(), target.height(), GL_R32UI);
    images.width = target.width();
    images.height = target.height();
  }
  const std::int64_t bodies = instances.counts.bodies;
  const GLuint zero[2] = {}, none = 0xffffffffu;
  larges_.reserve((static_cast<std::size_t>(bodies) + 2) * sizeof(GLuint));
  glClearNamedBufferSubData(larges_.get(), GL_RG32UI, 0, sizeof zero, GL_RG_INTEGER, GL_UNSIGNED_INT, zero);
  glClearTexImage(images.nearest.get(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT, zero);
  if (!shadow) glClearTexImage(images.owners.get(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT, &none);

  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, instances.bodies.get());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, larges_.get());
  glBindImageTexture(0, images.nearest.get(), 0, GL_FALSE, 0, GL_READ_WRITE, GL_R32UI);
  glBindImageTexture(1, shadow ? images.nearest.get() : images.owners.get(), 0, GL_FALSE, 0, GL_READ_WRITE,
                     GL_R32UI);
  for (const gl::Program* program : {&small_, &large_}) program->set("at_least_a_pixel", shadow ? 0 : 1);
  dispatch(bodies, false);
  if (!shadow) {
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    dispatch(bodies, true);
  }
  // The merge reads these images; the next picture clears them.
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT |
                  GL_BUFFER_UPDATE_BARRIER_BIT);

  (shadow ? merge_shadow_ : merge_surface_).use();
  nothing_.bind(0, 0);
  glBindTextureUnit(0, colors);
  glBindTextureUnit(1, images.nearest.get());
  if (!shadow) glBindTextureUnit(2, images.owners.get());
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace collidoscope

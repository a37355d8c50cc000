#include "viewer/render/line_cull.h"

#include "viewer/render/gl/errors.h"

namespace collidoscope {

namespace {
constexpr int tile = 8, lanes = 256;  // constants of depth_tiles.comp and line_cull.comp
constexpr int groups_of(int count, int each) { return (count + each - 1) / each; }
}  // namespace

LineCull::LineCull()
    : tiles_(gl::Program::compute("depth_tiles.comp")),
      mark_boxes_(gl::Program::compute("line_cull.comp", "#define MARK\n")),
      mark_contacts_(gl::Program::compute("line_cull.comp", "#define MARK\n#define CONTACTS\n")),
      sum_(gl::Program::compute("line_cull.comp", "#define SUM\n")),
      list_(gl::Program::compute("line_cull.comp", "#define LIST\n")),
      ranks_("line ranks"),
      starts_("lines per group"),
      listed_("visible lines") {}

void LineCull::look_at(const gl::Target& surfaces, bool cull) {
  culling_ = cull;
  const int width = groups_of(surfaces.width(), tile), height = groups_of(surfaces.height(), tile);
  if (width != width_ || height != height_) depths_ = gl::make_texture("tile depth", width, height, GL_R32F);
  width_ = width;
  height_ = height;
  tiles_.use();
  glBindTextureUnit(0, surfaces.depth());
  glBindImageTexture(0, depths_.get(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
  glDispatchCompute(static_cast<GLuint>(width), static_cast<GLuint>(height), 1);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  gl::check("compute the tile depth");
}

void LineCull::list(Kind kind, int first, int count, int vertices_each, float low, float high) {
  const int groups = groups_of(count, lanes);
  constexpr std::size_t word = sizeof(GLuint);
  ranks_.reserve(static_cast<std::size_t>(count) * word);
  starts_.reserve(static_cast<std::size_t>(groups) * word);
  listed_.reserve((static_cast<std::size_t>(count) + 5) * word);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, ranks_.get());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, starts_.get());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, listed_.get());
  const gl::Program& mark = kind == Kind::boxes ? mark_boxes_ : mark_contacts_;
  if (kind == Kind::boxes) mark.set("range", low, high, 0, 0);
  mark.set("first", first);
  mark.set("cull", culling_ ? 1 : 0);
  mark.set("count", count);
  sum_.set("count", count);
  list_.set("count", count);
  sum_.set("vertices_each", vertices_each);

  glBindTextureUnit(1, depths_.get());
  mark.use();
  glDispatchCompute(static_cast<GLuint>(groups), 1, 1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  sum_.use();
  glDispatchCompute(1, 1, 1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  list_.use();
  glDispatchCompute(static_cast<GLuint>(groups), 1, 1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, listed_.get());
  gl::check("list " + std::to_string(count) + " lines");
}

}  // namespace collidoscope

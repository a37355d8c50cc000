#pragma once
// Draws spheres by compute shaders instead of the rasteriser: the picture is that of their quads
// (body_pass.h), and costs less where they are many and small. Owns its programs and the images that it draws
// into first; belongs to a BodyPass.

#include <cstdint>
#include <optional>

#include "viewer/render/gl/program.h"
#include "viewer/render/gl/target.h"
#include "viewer/render/gl/vertex_layout.h"
#include "viewer/render/instance_buffers.h"

namespace collidoscope {

class SphereCompute {
 public:
  SphereCompute();

  /// Whether this machine's shaders can reach so many records.
  bool fits(std::int64_t bodies) const;
  /// All bodies that are spheres, into the bound `target`, by its depth test: albedo, normal and depth, or
  /// depth alone. With the bound frame uniforms and `colors`, the colour map's texture.
  void draw(const InstanceBuffers& instances, bool shadow, GLuint colors, const gl::Target& target);

 private:
  struct Images {
    gl::TextureHandle nearest, owners;
    int width = 0, height = 0;
  };
  void dispatch(std::int64_t bodies, bool second_round) const;

  gl::Program small_, large_, merge_surface_, merge_shadow_;
  gl::VertexLayout nothing_;
  gl::Buffer larges_{"large spheres"};
  Images surface_, shadow_;
  std::int64_t max_bytes_ = 0;  ///< of a buffer that shaders read
};

}  // namespace collidoscope

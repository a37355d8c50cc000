#pragma once
// Draws spheres by compute shaders instead of the rasteriser. The picture equals that of the quads
// (body_pass.h), at lower cost for many small spheres. Owns its programs and intermediate images; part of a
// BodyPass.

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

  /// Whether the shaders of this machine can access this many records.
  bool fits(std::int64_t bodies) const;
  /// Draws all spheres into the bound `target` with depth test: albedo, normal and depth, or only depth.
  /// Frame uniforms must be bound; `colors` is the colour map texture.
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
  std::int64_t max_bytes_ = 0;  ///< maximum size of a storage buffer
};

}  // namespace collidoscope

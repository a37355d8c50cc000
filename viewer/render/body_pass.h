#pragma once
// Draws all bodies: spheres as ray-cast quads, meshes by their faces. Owns its programs and the meshes'
// vertices. The same geometry serves three passes.

#include <vector>

#include "viewer/render/frame_scene.h"
#include "viewer/render/gl/program.h"
#include "viewer/render/gl/vertex_layout.h"
#include "viewer/render/instance_buffers.h"

namespace collidoscope {

class BodyPass {
 public:
  enum class Output {
    surface,  ///< albedo, normal and depth
    ids,      ///< id + 1 and depth
    shadow    ///< depth alone
  };

  BodyPass();
  void set_scene(const FrameScene& scene);
  /// Into the bound framebuffer, with the bound frame uniforms and `colors`, the colour map's texture.
  void draw(const InstanceBuffers& instances, Output output, GLuint colors) const;

 private:
  std::vector<gl::Program> spheres_, meshes_;  // by Output
  gl::VertexLayout sphere_layout_, mesh_layout_;
  gl::Buffer vertices_;
  struct Range {
    GLint first;
    GLsizei count;
  };
  std::vector<Range> ranges_;  // of each mesh in vertices_
  std::vector<FrameScene::Run> runs_;
};

}  // namespace collidoscope

#pragma once
// Draws all bodies: spheres as ray-cast quads or by compute, meshes by their faces. Owns its programs and the
// meshes' vertices. The same geometry serves three passes.

#include <optional>
#include <vector>

#include "viewer/render/frame_scene.h"
#include "viewer/render/gl/program.h"
#include "viewer/render/gl/vertex_layout.h"
#include "viewer/render/instance_buffers.h"
#include "viewer/render/sphere_compute.h"

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
  /// Into the bound `target`, with the bound frame uniforms and `colors`, the colour map's texture.
  /// `compute`: spheres by compute where the machine can; ids never are, since their targets are small and
  /// rarely drawn.
  void draw(const InstanceBuffers& instances, Output output, GLuint colors, const gl::Target& target,
            bool compute);

 private:
  void draw_run(const InstanceBuffers& instances, std::size_t output, const FrameScene::Run& run) const;

  std::vector<gl::Program> spheres_, meshes_;  // by Output
  gl::VertexLayout sphere_layout_, mesh_layout_;
  gl::Buffer vertices_;
  struct Range {
    GLint first;
    GLsizei count;
  };
  std::vector<Range> ranges_;  // of each mesh in vertices_
  std::vector<FrameScene::Run> runs_;
  bool any_spheres_ = false;
  std::optional<SphereCompute> sphere_compute_;  // made at first use
};

}  // namespace collidoscope

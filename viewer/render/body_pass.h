#pragma once
// Draws all bodies: spheres as ray-cast quads or by compute shaders, meshes as triangles. Owns its programs
// and the mesh vertices. Used for surfaces, ids and shadows.

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
    shadow    ///< only depth
  };

  BodyPass();
  void set_scene(const FrameScene& scene);
  /// Draws into the bound `target`. Frame uniforms must be bound; `colors` is the colour map texture.
  /// `compute`: draw spheres by compute shaders if supported. Ids always use quads, since their targets are
  /// small and rarely drawn.
  void draw(const InstanceBuffers& instances, Output output, GLuint colors, const gl::Target& target,
            bool compute);
  /// Draws `count` bodies from body `first` on, spheres as quads.
  void draw_part(const InstanceBuffers& instances, Output output, GLuint colors, std::int64_t first,
                 std::int64_t count);

 private:
  void draw_run(const InstanceBuffers& instances, std::size_t output, const FrameScene::Run& run) const;

  std::vector<gl::Program> spheres_, meshes_;  // indexed by Output
  gl::VertexLayout sphere_layout_, mesh_layout_;
  gl::Buffer vertices_;
  struct Range {
    GLint first;
    GLsizei count;
  };
  std::vector<Range> ranges_;  // range of each mesh in vertices_
  std::vector<FrameScene::Run> runs_;
  bool any_spheres_ = false;
  std::optional<SphereCompute> sphere_compute_;  // created on first use
};

}  // namespace collidoscope

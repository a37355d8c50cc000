#pragma once
// Draws a state: a frame is a function of the published records, the camera and the layers, and of nothing
// else. Owns its framebuffers, passes and instance buffers; needs the GL context that was current when it was
// made.

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "viewer/render/body_pass.h"
#include "viewer/render/draw_options.h"
#include "viewer/render/frame_layers.h"
#include "viewer/render/frame_uniforms.h"
#include "viewer/render/ghost_pass.h"
#include "viewer/render/gl/pass_clock.h"
#include "viewer/render/image.h"
#include "viewer/render/light_pass.h"
#include "viewer/render/line_pass.h"
#include "viewer/render/plane_pass.h"

namespace collidoscope {

/// What an id buffer shows.
struct IdLayers {
  bool bodies = true;  ///< id + 1
  bool boxes = false;  ///< 0x80000000 + place in the published boxes, faces filled; nearest wins
  bool edges = false;  ///< of boxes the edges alone
  /// Of boxes those whose value lies between.
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
};

class Renderer {
 public:
  /// Picture size in pixels.
  Renderer(int width, int height, DrawOptions options = {});

  void set_scene(const FrameScene& scene);
  const FrameScene& scene() const { return scene_; }
  void resize(int width, int height);
  /// From the next frame on.
  void set_options(const DrawOptions& options);
  const DrawOptions& options() const { return options_; }
  /// Whether the spheres of such a state are drawn by compute, as `options` and the machine decide.
  bool computes_spheres() const;
  int width() const { return picture_->width(); }
  int height() const { return picture_->height(); }

  /// Filled by whoever publishes, before draw().
  InstanceBuffers& instances() { return instances_; }

  /// Boxes that draw() draws on top, whatever the layers are; of each, the value is its BoxMark.
  void set_marks(std::span<const BoxInstance> boxes);

  /// What draw() draws where the layers ask for ghosts or errors.
  void set_ghosts(std::span<const GhostInstance> ghosts) { ghosts_.set(ghosts); }

  /// `clock`: told of each pass, if somebody measures.
  void draw(const OrbitCamera& camera, const FrameLayers& layers, const ValueRange& values,
            gl::PassClock* clock = nullptr);
  Image read_picture() const;
  /// Until the GPU has drawn all that it was asked for, by anybody.
  static void finish();
  /// The framebuffer that holds the picture: text and panels are drawn on top of it.
  const gl::Target& picture() const { return *picture_; }

  /// One id for each pixel of the picture, rows from the top, 0 where there is nothing. Drawn as asked, apart
  /// from draw(): never blended, one sample at the middle of each pixel.
  std::vector<std::uint32_t> draw_ids(const OrbitCamera& camera, const IdLayers& layers);
  /// The one at a pixel, counted from the top left corner; nothing else is read back.
  std::uint32_t pick(const OrbitCamera& camera, const IdLayers& layers, int x, int y);
  /// The place in the published boxes of the one with an edge nearest to a pixel, at most `reach` pixels
  /// away, of those that neither bodies nor other edges hide.
  std::optional<std::uint32_t> pick_box(const OrbitCamera& camera, IdLayers layers, int x, int y, int reach);

 private:
  void draw_id_target(const OrbitCamera& camera, const IdLayers& layers);
  void bind_uniforms(const gl::Buffer& buffer) const;
  void resolve() const;  ///< the lit picture into the one that is shown

  DrawOptions options_;
  bool software_;  // the CPU draws
  FrameScene scene_;
  InstanceBuffers instances_;
  BodyPass bodies_;
  LinePass lines_;
  std::optional<LightPass> light_;
  PlanePass planes_;
  GhostPass ghosts_;
  gl::Program resolve_;
  gl::VertexLayout nothing_;
  gl::Buffer camera_uniforms_{"camera"}, light_uniforms_{"light"}, walls_{"walls"}, marks_{"marks"};
  std::int64_t mark_count_ = 0;
  int last_mark_level_ = 0;
  gl::TextureHandle colors_, heat_;  ///< of bodies, of boxes
  std::optional<gl::Target> surface_, lit_, picture_, ids_;
};

}  // namespace collidoscope

#pragma once
// Draws a state. A frame is a pure function of the published records, the camera and the layers. Owns its
// framebuffers, passes and instance buffers. Requires the GL context of its construction.

#include <cstdint>
#include <functional>
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

/// Contents of an id buffer.
struct IdLayers {
  bool bodies = true;  ///< id + 1
  bool boxes = false;  ///< 0x80000000 + index of the published box, faces filled, nearest first
  bool edges = false;  ///< draw only the edges of boxes
  /// Value range of the drawn boxes.
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
};

class Renderer {
 public:
  /// Size of the picture in pixels.
  Renderer(int width, int height, DrawOptions options = {});

  void set_scene(const FrameScene& scene);
  const FrameScene& scene() const { return scene_; }
  void resize(int width, int height);
  /// Takes effect in the next frame.
  void set_options(const DrawOptions& options);
  const DrawOptions& options() const { return options_; }
  /// Whether spheres are drawn by compute shaders, given the options and the machine.
  bool computes_spheres() const;
  int width() const { return picture_->width(); }
  int height() const { return picture_->height(); }

  /// Fill these buffers before draw().
  InstanceBuffers& instances() { return instances_; }

  /// Boxes drawn on top, independent of the layers. Their values are BoxMarks.
  void set_marks(std::span<const BoxInstance> boxes);

  /// Reference positions for the layers ghosts and error vectors.
  void set_ghosts(std::span<const GhostInstance> ghosts) { ghosts_.set(ghosts); }

  /// `clock`: optional timer of the passes.
  void draw(const OrbitCamera& camera, const FrameLayers& layers, const ValueRange& values,
            gl::PassClock* clock = nullptr);
  /// Draws a picture in parts, so that a slow renderer does not block the caller. draw_slice() continues for
  /// about `milliseconds` and returns whether the picture is complete. Until then picture() is the previous
  /// one, unless the size was changed. Everything that is drawn must stay the same between the calls.
  void begin_slices(const OrbitCamera& camera, const FrameLayers& layers, const ValueRange& values);
  bool draw_slice(double milliseconds);
  Image read_picture() const;
  /// Waits until the GPU has finished all commands.
  static void finish();
  /// The framebuffer with the picture. Text and panels are drawn on top of it.
  const gl::Target& picture() const { return previous_ ? *previous_ : *picture_; }

  /// One id per pixel of the picture, rows from the top; 0: background. Independent of draw(): no blending,
  /// one sample per pixel.
  std::vector<std::uint32_t> draw_ids(const OrbitCamera& camera, const IdLayers& layers);
  /// Id at one pixel, counted from the top left corner. Only this pixel is read back.
  std::uint32_t pick(const OrbitCamera& camera, const IdLayers& layers, int x, int y);
  /// Index of the published box whose visible edge is nearest to the pixel, within `reach` pixels. Edges
  /// hidden by bodies or other edges are ignored.
  std::optional<std::uint32_t> pick_box(const OrbitCamera& camera, IdLayers layers, int x, int y, int reach);

 private:
  /// A picture that is being drawn.
  struct Frame {
    FrameUniforms camera, light;
    FrameLayers layers;
    ValueRange values;
    int last_level = 0;
    std::int64_t drawn = 0;        ///< bodies, into the shadow map and then into the picture
    std::int64_t per_part = 4096;  ///< bodies between two looks at the clock
  };
  Frame frame_of(const OrbitCamera& camera, const FrameLayers& layers, const ValueRange& values) const;
  void prepare_light();  ///< for the present options
  void bind(const Frame& frame);
  void begin_surface(bool clear);
  void light_and_layers(const Frame& frame, const std::function<void(const char*)>& mark);
  void draw_id_target(const OrbitCamera& camera, const IdLayers& layers);
  void bind_uniforms(const gl::Buffer& buffer) const;
  void resolve() const;  ///< resolves the lit picture into the displayed one

  DrawOptions options_;
  bool software_;  // the renderer runs on the CPU
  FrameScene scene_;
  InstanceBuffers instances_;
  BodyPass bodies_;
  LinePass lines_;
  std::optional<LightPass> light_;
  PlanePass planes_;
  GhostPass ghosts_;
  std::optional<gl::PixelPass> resolve_;
  gl::Buffer camera_uniforms_{"camera"}, light_uniforms_{"light"}, walls_{"walls"}, marks_{"marks"};
  std::int64_t mark_count_ = 0;
  int last_mark_level_ = 0;
  gl::TextureHandle colors_, heat_;  ///< colour maps of bodies and boxes
  std::optional<gl::Target> surface_, lit_, picture_, ids_;
  std::optional<gl::Target> previous_;  ///< picture of the former size, until the next one is complete
  std::optional<Frame> sliced_;
};

}  // namespace collidoscope

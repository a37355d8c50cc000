#pragma once
// The 3D view: draws a published state in its area of the window and picks bodies and boxes. Owns the
// renderer, the display path and the camera. Requires the GL context of its construction.

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "ui/workspace.h"
#include "viewer/render/interop/display_link.h"
#include "viewer/render/legend.h"
#include "viewer/render/renderer.h"
#include "viewer/session/tree_inspector.h"
#include "viewer/view/published_state.h"
#include "viewer/view/view_scale.h"

namespace collidoscope {

class SceneView {
 public:
  /// `request`: the display path; `log` receives one line per fallback.
  SceneView(DisplayPath request, const DrawRequest& draw, DisplayLink::LogCallback log);

  /// Updates camera and buffers, and draws the view at `width` x `height` pixels. A slow renderer draws fewer
  /// pixels while the view changes, and a part of the picture per call; is_drawing() then returns true and
  /// `state` must stay the same. Nothing is drawn if nothing changed.
  void draw(const PublishedState& state, const Workspace& workspace, const TreeInspector& tree, int width,
            int height);
  bool is_drawing() const { return drawing_.has_value(); }
  /// Completes the picture.
  void finish_drawing();
  int width() const { return width_; }
  int height() const { return height_; }
  /// Drawn pixels per shown pixel, along an axis.
  double scale() const { return drawn_.scale; }

  bool has_renderer() const { return renderer_.has_value(); }  ///< false before the first draw()
  Renderer& renderer() { return *renderer_; }
  OrbitCamera& camera() { return camera_; }
  /// The camera was moved by hand: a new window size keeps it.
  void camera_was_moved() { camera_moved_ = true; }
  /// The scene was replaced: the camera is reset to that of the new scene.
  void forget_camera() { camera_set_ = camera_moved_ = false; }
  /// `live`: needed for CameraRequest::frame_all, and for frame_selection without a selection.
  void handle_request(CameraRequest request, LiveWorld& live);
  /// The body at a pixel, else the box with an edge near it.
  struct Picked {
    std::optional<std::uint32_t> body;
    std::optional<std::uint32_t> box;  ///< index among the drawn boxes, from the first drawn level
  };
  Picked pick(int x, int y);

  const std::string& display_path() const { return path_name_; }
  const std::optional<BodyReport>& selected() const { return selected_; }
  /// Metres, size of the scene's bounds without added bodies.
  double scene_size() const { return renderer_ ? renderer_->scene().size : 1; }
  /// Outline of the selected body in pixels of the view.
  std::vector<std::pair<double, double>> outline() const;
  /// Outlines of the bodies of wrong pairs, in pixels of the 3D view.
  std::vector<WorkspaceView::FaultyPairView> faulty_pairs() const;
  /// Outlines of the first hundred frozen bodies.
  std::vector<std::vector<std::pair<double, double>>> frozen_outlines() const;

 private:
  void draw_slice(double milliseconds);
  void follow_scene(const PublishedState& state);
  void follow_selection(const PublishedState& state, const Workspace& workspace);
  void mark(const Workspace& workspace, const TreeInspector& tree);
  void upload(const PublishedState& state);
  double aspect() const { return static_cast<double>(width_) / height_; }

  DisplayPath display_path_request_;
  DrawRequest draw_request_;
  DisplayLink::LogCallback log_;
  std::optional<Renderer> renderer_;
  std::optional<DisplayLink> link_;
  std::string path_name_ = "none";
  OrbitCamera camera_;
  bool camera_moved_ = false, camera_set_ = false;
  std::shared_ptr<const PublishedState::SceneData> data_;  ///< of the scene in the renderer

  // Contents of the buffers: they are filled again only when this changes.
  PublishedState::Key published_;
  ValueRange range_;

  // Body and state of `selected_`.
  struct Inspected {
    int generation = -1;
    std::int64_t step = -1;
    std::uint32_t id = 0;
    friend bool operator==(const Inspected&, const Inspected&) = default;
  } inspected_;
  std::optional<BodyReport> selected_;

  std::vector<PublishedState::Frozen> frozen_;
  std::vector<PublishedState::FaultyPairBodies> faulty_pairs_;

  // Source of the boxes on top of the picture.
  struct Marked {
    Inspected body;
    bool path = false;
    int tree = -1, visit = 0;
    friend bool operator==(const Marked&, const Marked&) = default;
  } marked_;
  std::optional<Bounds> node_;  ///< bounds of the selected node

  // Contents of the picture: it is drawn again only when this changes.
  struct Drawn {
    PublishedState::Key state;
    FrameLayers layers;
    Marked marked;
    OrbitCamera camera;
    DrawOptions options;
    int width = 0, height = 0;
    double scale = 0;
    friend bool operator==(const Drawn&, const Drawn&) = default;
  } drawn_;
  std::optional<Drawn> drawing_;
  double drawing_seconds_ = 0;
  int width_ = 1, height_ = 1;
  ViewScale view_scale_;
  std::chrono::steady_clock::time_point changed_;
};

}  // namespace collidoscope

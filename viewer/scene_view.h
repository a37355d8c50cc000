#pragma once
// The 3D view: draws a LiveWorld where the layout has room for it, and answers what is under the pointer.
// Owns the renderer, the display path and the camera; needs the GL context that was current when it was made.

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "ui/workspace.h"
#include "viewer/render/interop/display_link.h"
#include "viewer/render/legend.h"
#include "viewer/render/renderer.h"
#include "viewer/session/live_reference.h"
#include "viewer/session/live_world.h"
#include "viewer/session/tree_inspector.h"
#include "viewer/view_scale.h"

namespace collidoscope {

class SceneView {
 public:
  /// `request`: the display path; `log` gets a line for each step down.
  SceneView(DisplayPath request, const DrawRequest& draw, DisplayLink::LogCallback log);

  /// Brings camera and buffers to what is to be drawn, and draws it for `width` x `height` pixels: on a slow
  /// renderer fewer while it changes, and nothing while it does not.
  void draw(LiveWorld& live, const Workspace& workspace, const TreeInspector& tree, LiveReference& reference,
            int width, int height);
  int width() const { return width_; }
  int height() const { return height_; }
  /// Pixels drawn for each of them, along an axis.
  double scale() const { return drawn_.scale; }

  bool has_renderer() const { return renderer_.has_value(); }  ///< false until the first draw()
  Renderer& renderer() { return *renderer_; }
  OrbitCamera& camera() { return camera_; }
  /// From now on the camera is somebody's choice: a new window size keeps it.
  void camera_was_moved() { camera_moved_ = true; }
  /// Another scene: the camera looks as that one requests.
  void forget_camera() { camera_set_ = camera_moved_ = false; }
  void handle_request(CameraRequest request, LiveWorld& live);
  /// The body at a pixel of the view; where there is none, the box whose edge is near.
  struct Picked {
    std::optional<std::uint32_t> body;
    std::optional<std::uint32_t> box;  ///< place among those that are drawn, from the first level drawn
  };
  Picked pick(int x, int y);

  const std::string& display_path() const { return path_name_; }
  const Legend& body_legend() const { return body_legend_; }
  const Legend& box_legend() const { return box_legend_; }
  const ValueRange& range() const { return range_; }
  const std::optional<BodyReport>& selected() const { return selected_; }
  /// Metres: of the scene's bounds, without bodies that were added.
  double scene_size() const { return renderer_ ? renderer_->scene().size : 1; }
  /// The selected body's outline in pixels of the view.
  std::vector<std::pair<double, double>> outline() const;
  /// So of what is frozen; of the first hundred such.
  std::vector<std::vector<std::pair<double, double>>> frozen_outlines() const;

 private:
  void follow_world(LiveWorld& live);
  void follow_frozen(LiveWorld& live);
  void follow_selection(LiveWorld& live, const Workspace& workspace);
  void mark(const Workspace& workspace, const TreeInspector& tree);
  void publish(LiveWorld& live, const Workspace& workspace, LiveReference& reference);
  double aspect() const { return static_cast<double>(width_) / height_; }

  DisplayPath display_path_request_;
  DrawRequest draw_request_;
  DisplayLink::LogCallback log_;
  std::optional<Renderer> renderer_;
  std::optional<DisplayLink> link_;
  std::string path_name_ = "none";
  OrbitCamera camera_;
  bool camera_moved_ = false, camera_set_ = false;
  int generation_ = -1;
  Camera scene_camera_request_;

  // What the buffers hold: they are filled anew only when it changes.
  struct Published {
    int generation = -1;
    std::int64_t step = -1;
    FrameLayers layers;
    int reference = 0;
    friend bool operator==(const Published&, const Published&) = default;
  } published_;
  ValueRange range_;
  Legend body_legend_, box_legend_;

  // Of which body and state `selected_` speaks.
  struct Inspected {
    int generation = -1;
    std::int64_t step = -1;
    std::uint32_t id = 0;
    friend bool operator==(const Inspected&, const Inspected&) = default;
  } inspected_;
  std::optional<BodyReport> selected_;

  struct Frozen {
    std::uint32_t id;
    Vector3d at;    ///< m
    double radius;  ///< m
  };
  std::vector<Frozen> frozen_;  ///< they stay where they are
  int frozen_generation_ = -1;

  // Of what the boxes on top of the picture are.
  struct Marked {
    Inspected body;
    bool path = false;
    int tree = -1, visit = 0;
    friend bool operator==(const Marked&, const Marked&) = default;
  } marked_;
  std::optional<Bounds> node_;  ///< selected

  // What the picture shows: it is drawn anew only when it changes.
  struct Drawn {
    Published state;
    Marked marked;
    OrbitCamera camera;
    DrawOptions options;
    int highlighted_level = -1;
    int width = 0, height = 0;
    double scale = 0;
    friend bool operator==(const Drawn&, const Drawn&) = default;
  } drawn_;
  int width_ = 1, height_ = 1;
  ViewScale view_scale_;
  std::chrono::steady_clock::time_point changed_;
};

}  // namespace collidoscope

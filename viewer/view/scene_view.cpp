#include "viewer/view/scene_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim_cuda/core/wall_clock.h"
#include "viewer/render/gl/errors.h"
#include "viewer/session/tree_marks.h"
#include "viewer/view/camera_control.h"

namespace collidoscope {
namespace {

bool same_box(const std::optional<Box>& a, const std::optional<Box>& b) {
  return a && b ? a->min == b->min && a->max == b->max : a.has_value() == b.has_value();
}

}  // namespace

SceneView::SceneView(DisplayPath request, const DrawRequest& draw, DisplayLink::LogCallback log)
    : display_path_request_(request), draw_request_(draw), log_(std::move(log)) {}

void SceneView::follow_scene(const PublishedState& state) {
  if (data_ == state.scene || (data_ && data_->generation == state.scene->generation)) return;
  data_ = state.scene;
  const std::optional<Box> before = renderer_->scene().box;
  renderer_->set_scene(data_->frame);
  link_.emplace(data_->info, display_path_request_, log_);
  path_name_ = display_path_name(link_->path());
  // If the box changed, the camera keeps its direction and frames the new box. Added bodies do not move it.
  if (camera_set_ && !same_box(before, renderer_->scene().box))
    camera_ = frame_all(renderer_->scene().bounds, aspect(), camera_);
}

void SceneView::follow_selection(const PublishedState& state, const Workspace& workspace) {
  if (!state.selected || workspace.selection != state.selected->id) {
    selected_.reset();
    return;
  }
  const Inspected wanted{state.selected_generation, state.selected_step, state.selected->id};
  if (selected_ && wanted == inspected_) return;
  const bool same = selected_ && selected_->id == wanted.id;
  const Vector3d before = same ? selected_->X : Vector3d(0, 0, 0);
  selected_ = state.selected;
  inspected_ = wanted;
  if (workspace.follow) camera_.target = same ? camera_.target + selected_->X - before : selected_->X;
}

void SceneView::mark(const Workspace& workspace, const TreeInspector& tree) {
  node_.reset();
  const TreePanelView* panel = tree.view();
  if (panel != nullptr && panel->node)
    node_ = Bounds{Eigen::Map<const Vector3f>(panel->node->min).cast<double>(),
                   Eigen::Map<const Vector3f>(panel->node->max).cast<double>()};
  const Marked wanted{selected_ ? inspected_ : Inspected{}, workspace.show_path, tree.version(),
                      static_cast<int>(workspace.tree.visit)};
  if (wanted == marked_) return;
  renderer_->set_marks(tree_marks(workspace, selected_ ? &*selected_ : nullptr, panel));
  marked_ = wanted;
}

void SceneView::upload(const PublishedState& state) {
  if (state.key == published_) return;
  if (state.key.layers.needs_reference()) renderer_->set_ghosts(state.ghosts);
  link_->show(state.records, renderer_->instances());
  path_name_ = display_path_name(link_->path());
  range_ = state.range;
  published_ = state.key;
}

void SceneView::draw(const PublishedState& state, const Workspace& workspace, const TreeInspector& tree,
                     int width, int height) {
  using Clock = std::chrono::steady_clock;
  constexpr double slice = 14;  // ms per call
  if (drawing_) return draw_slice(slice);
  width_ = width;
  height_ = height;
  const bool software = gl::is_software_renderer();
  const DrawOptions options = live_options(draw_request_, software, state.scene->frame.body_count);
  if (!renderer_) renderer_.emplace(width, height, options);
  renderer_->set_options(options);
  follow_scene(state);
  const bool resized = drawn_.width != width || drawn_.height != height;
  if (!camera_set_ || (resized && !camera_moved_)) {
    const bool orthographic = camera_.orthographic;
    camera_ = scene_camera(data_->camera, renderer_->scene().bounds, aspect());
    camera_.orthographic = orthographic;
    camera_set_ = true;
  }
  frozen_ = state.frozen;
  faulty_pairs_ = state.faulty_pairs;
  follow_selection(state, workspace);
  mark(workspace, tree);
  upload(state);

  FrameLayers layers = published_.layers;
  layers.grid = workspace.layers.grid;
  layers.walls = workspace.layers.walls;
  layers.highlighted_level = workspace.hovered_level;
  Drawn wanted{published_, layers, marked_, camera_, options, width, height, drawn_.scale};
  const Clock::time_point start = Clock::now();
  const auto since = std::chrono::duration<double>(start - changed_).count();
  if (!(wanted == drawn_)) {
    view_scale_.changed(since);
    changed_ = start;
  }
  // Shortly after the last change the view is drawn at full resolution.
  const bool moves = !(wanted == drawn_) || since < 0.25;
  const bool may = software && !draw_request_.supersampling && !workspace.screenshot_requested;
  wanted.scale = may && moves ? view_scale_.scale() : 1;
  if (wanted == drawn_) return;
  const auto pixels = [&](int size) {
    return std::max(static_cast<int>(std::lround(wanted.scale * size)), 1);
  };
  renderer_->resize(pixels(width), pixels(height));
  if (!software || renderer_->computes_spheres()) {  // only quads are drawn in parts
    renderer_->draw(camera_, layers, range_);
    drawn_ = wanted;
    return;
  }
  renderer_->begin_slices(camera_, layers, range_);
  drawing_ = wanted;
  drawing_seconds_ = 0;
  draw_slice(slice);
}

void SceneView::draw_slice(double milliseconds) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  const bool complete = renderer_->draw_slice(milliseconds);
  drawing_seconds_ += seconds_since(start);
  if (!complete) return;
  view_scale_.took(drawing_->scale, drawing_seconds_);
  drawn_ = *drawing_;
  drawing_.reset();
}

void SceneView::finish_drawing() {
  if (drawing_) draw_slice(std::numeric_limits<double>::infinity());
}

void SceneView::handle_request(CameraRequest request, LiveWorld& live) {
  if (request == CameraRequest::none || !renderer_) return;
  camera_moved_ = true;
  switch (request) {
    case CameraRequest::none:
      break;
    case CameraRequest::frame_selection:
      if (node_) {
        camera_ = frame_all(*node_, aspect(), camera_);
        break;
      }
      if (selected_) {
        const Vector3d room = Vector3d(1, 1, 1) * (4 * selected_->radius);
        camera_ = frame_all({selected_->X - room, selected_->X + room}, aspect(), camera_);
        break;
      }
      [[fallthrough]];
    case CameraRequest::frame_all:
      camera_ = frame_all(scene_bounds(live.world().scene(), live.world().initial().box,
                                       live.world().bodies().position, live.world().initial().radius),
                          aspect(), camera_);
      break;
    case CameraRequest::front:
      look_along(camera_, AxisView::front);
      break;
    case CameraRequest::side:
      look_along(camera_, AxisView::side);
      break;
    case CameraRequest::top:
      look_along(camera_, AxisView::top);
      break;
    case CameraRequest::orthographic:
      camera_.orthographic = !camera_.orthographic;
      break;
  }
}

SceneView::Picked SceneView::pick(int x, int y) {
  if (!renderer_) return {};
  x = x * renderer_->width() / width_;
  y = y * renderer_->height() / height_;
  const FrameLayers& shown = published_.layers;
  IdLayers layers;
  layers.bodies = shown.spheres;
  if (layers.bodies)
    if (const std::uint32_t id = renderer_->pick(camera_, layers, x, y)) return {id - 1, std::nullopt};
  if (!shown.boxes) return {};
  if (shown.box_color != NodeMetric::level) {
    layers.low = static_cast<double>(shown.box_low);
    layers.high = static_cast<double>(shown.box_high);
  }
  constexpr int reach = 4;  // pixels of tolerance for clicks on lines
  return {std::nullopt, renderer_->pick_box(camera_, layers, x, y, reach)};
}

std::vector<std::vector<std::pair<double, double>>> SceneView::frozen_outlines() const {
  std::vector<std::vector<std::pair<double, double>>> outlines;
  constexpr double room = 1.08;  // margin of the outline around the selected body
  for (const PublishedState::Frozen& body : frozen_)
    outlines.push_back(sphere_outline(camera_, body.at, room * body.radius, width_, height_));
  return outlines;
}

std::vector<WorkspaceView::FaultyPairView> SceneView::faulty_pairs() const {
  std::vector<WorkspaceView::FaultyPairView> pairs;
  const auto outline_of = [&](const Vector3d& at, double radius, auto& points) {
    for (const auto& [x, y] : sphere_outline(camera_, at, radius, width_, height_))
      points.emplace_back(static_cast<float>(x), static_cast<float>(y));
  };
  for (const PublishedState::FaultyPairBodies& pair : faulty_pairs_) {
    WorkspaceView::FaultyPairView& view = pairs.emplace_back();
    view.text = pair.text;
    outline_of(pair.a, pair.radius_a, view.a);
    outline_of(pair.b, pair.radius_b, view.b);
  }
  return pairs;
}

std::vector<std::pair<double, double>> SceneView::outline() const {
  if (!selected_) return {};
  return sphere_outline(camera_, selected_->X, selected_->radius, width_, height_);
}

}  // namespace collidoscope

#include "viewer/scene_view.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "viewer/camera_control.h"
#include "viewer/render/gl/errors.h"
#include "viewer/render/value_range.h"
#include "viewer/session/tree_marks.h"

namespace collidoscope {
namespace {

bool same_box(const std::optional<Box>& a, const std::optional<Box>& b) {
  return a && b ? a->min == b->min && a->max == b->max : a.has_value() == b.has_value();
}

}  // namespace

SceneView::SceneView(DisplayPath request, const DrawRequest& draw, DisplayLink::LogCallback log)
    : display_path_request_(request), draw_request_(draw), log_(std::move(log)) {}

void SceneView::follow_world(LiveWorld& live) {
  if (generation_ == live.generation()) return;
  World& world = live.world();
  const std::optional<Box> before = renderer_->scene().box;
  renderer_->set_scene(frame_scene(world.scene(), world.initial()));
  link_.emplace(world, display_path_request_, log_);
  path_name_ = display_path_name(link_->path());
  generation_ = live.generation();
  scene_camera_request_ = world.scene().camera;
  // If the box changed, the camera keeps its direction and frames the new box. Added bodies do not move it.
  if (camera_set_ && !same_box(before, renderer_->scene().box))
    camera_ = frame_all(renderer_->scene().bounds, aspect(), camera_);
}

void SceneView::follow_frozen(LiveWorld& live) {
  constexpr std::size_t most = 100;
  const std::vector<std::uint32_t>& ids = live.world().validation().frozen();
  const std::size_t shown = std::min(ids.size(), most);
  if (frozen_generation_ == live.generation() &&
      std::ranges::equal(frozen_, std::span(ids).first(shown), {}, &Frozen::id))
    return;
  frozen_generation_ = live.generation();
  frozen_.clear();
  if (shown == 0) return;
  const BodyStates bodies = live.world().bodies();
  for (const std::uint32_t id : std::span(ids).first(shown))
    frozen_.push_back({id, bodies.position[id], live.world().initial().radius[id]});
}

void SceneView::follow_selection(LiveWorld& live, const Workspace& workspace) {
  if (!workspace.selection || *workspace.selection >= live.world().initial().size()) {
    selected_.reset();
    return;
  }
  const Inspected wanted{live.generation(), live.world().steps(), *workspace.selection};
  if (selected_ && wanted == inspected_) return;
  const bool same = selected_ && selected_->id == wanted.id;
  const Vector3d before = same ? selected_->X : Vector3d(0, 0, 0);
  live.stats();  // measures the state, which computes its contacts and boxes
  selected_ = live.world().inspect(wanted.id);
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

void SceneView::publish(LiveWorld& live, const Workspace& workspace, LiveReference& reference) {
  Published wanted{live.generation(), live.world().steps(), workspace.layers, reference.version()};
  if (wanted == published_) return;
  if (workspace.layers.needs_reference()) {
    renderer_->set_ghosts(reference.ghosts(live.world(), live.generation()));
    wanted.reference = reference.version();
  }
  const FrameLayers layers = workspace.layers;
  const StepStats& stats = live.stats();  // measures the state, so that boxes and contacts match the bodies
  link_->publish(live.world(), layers, renderer_->instances());
  path_name_ = display_path_name(link_->path());
  range_ = value_range(live.world(), renderer_->scene(), layers, stats);
  body_legend_ = layers.spheres ? collidoscope::body_legend(layers.color, range_, stats) : Legend{};
  box_legend_ = layers.boxes ? collidoscope::box_legend(layers.box_color, range_) : Legend{};
  published_ = wanted;
}

void SceneView::draw(LiveWorld& live, const Workspace& workspace, const TreeInspector& tree,
                     LiveReference& reference, int width, int height) {
  using Clock = std::chrono::steady_clock;
  width_ = width;
  height_ = height;
  const bool software = gl::is_software_renderer();
  const auto bodies = static_cast<std::int64_t>(live.world().initial().size());
  const DrawOptions options = live_options(draw_request_, software, bodies);
  if (!renderer_) renderer_.emplace(width, height, options);
  renderer_->set_options(options);
  follow_world(live);
  const bool resized = drawn_.width != width || drawn_.height != height;
  if (!camera_set_ || (resized && !camera_moved_)) {
    const bool orthographic = camera_.orthographic;
    camera_ = scene_camera(scene_camera_request_, renderer_->scene().bounds, aspect());
    camera_.orthographic = orthographic;
    camera_set_ = true;
  }
  follow_frozen(live);
  follow_selection(live, workspace);
  mark(workspace, tree);
  publish(live, workspace, reference);

  Drawn wanted{published_, marked_, camera_, options, workspace.hovered_level, width, height, drawn_.scale};
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
  FrameLayers layers = workspace.layers;
  layers.highlighted_level = workspace.hovered_level;
  renderer_->draw(camera_, layers, range_);
  if (software) {
    Renderer::finish();
    view_scale_.took(wanted.scale, std::chrono::duration<double>(Clock::now() - start).count());
  }
  drawn_ = wanted;
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
  for (const Frozen& body : frozen_)
    outlines.push_back(sphere_outline(camera_, body.at, room * body.radius, width_, height_));
  return outlines;
}

std::vector<std::pair<double, double>> SceneView::outline() const {
  if (!selected_) return {};
  return sphere_outline(camera_, selected_->X, selected_->radius, width_, height_);
}

}  // namespace collidoscope

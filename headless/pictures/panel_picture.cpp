#include "headless/pictures/panel_picture.h"

#include "ui/colored_levels.h"
#include "viewer/render/legend.h"
#include "viewer/session/fill_view.h"
#include "viewer/session/tree_marks.h"

namespace collidoscope {

PanelPicture::PanelPicture(const World& world, const FrameLayers& layers, int width, int height, bool timings)
    : frame_(width, height) {
  workspace_.settings = settings_of(world);
  workspace_.layers = window_layers(layers);
  workspace_.playing = false;
  workspace_.hint = false;
  if (layers.tree) {  // the tree panel needs the space of the other panels
    PanelVisibility& visible_panels = workspace_.visible_panels;
    visible_panels.tree = true;
    visible_panels.timing = visible_panels.numbers = visible_panels.inspector = false;
  }
  workspace_.visible_panels.convergence = layers.convergence;
  view_.with_times = timings;
}

ScreenRect PanelPicture::scene_rect(int width, int height) {
  return scene_view_rect(Workspace{}, static_cast<float>(width), static_cast<float>(height),
                         workspace_font_size(width, height, 1));
}

void PanelPicture::set_renderer(const std::string& renderer, bool software, const std::string& display_path) {
  view_.renderer = renderer;
  view_.software = software;
  view_.display_path = display_path;
}

void PanelPicture::refresh(World& world, Renderer& renderer, const ReferenceView& reference) {
  view_.reference = reference;
  tree_.refresh(world, 0, workspace_);
  selected_.reset();
  if (workspace_.selection) selected_ = world.inspect(*workspace_.selection);
  renderer.set_marks(tree_marks(workspace_, selected_ ? &*selected_ : nullptr, tree_.view()));
}

void PanelPicture::record(World& world) {
  const StepStats stats = world.measure();
  record_step(world, &stats, history_);
}

void PanelPicture::fill(World& world, const StepStats& stats, const History& history,
                        const std::vector<std::int64_t>& level_sizes, const ValueRange& range) {
  fill_view(world, stats, history, view_);
  if (workspace_.visible_panels.effects) {
    if (!costs_.begun()) costs_.begin(world);
    view_.effect_views = costs_.views(world);
  }
  view_.level_sizes = level_sizes;
  const FrameLayers& layers = workspace_.layers;
  view_.body_colors = layers.spheres ? body_legend(layers.color, range, stats) : Legend{};
  view_.box_colors = layers.boxes ? box_legend(layers.box_color, range) : Legend{};
  view_.boxes_drawn = range.boxes;
  view_.contact_colors = contact_legend();
  view_.max_impulse = range.max_impulse;
  view_.error_scale = range.error_scale;
  view_.mark_colors = mark_legend();
  view_.tree = tree_.view();
  view_.selected = selected_ ? &*selected_ : nullptr;
  const auto [first, last] = colored_levels(layers, level_sizes.size(), view_.selected);
  view_.level_colors = level_legend(first, last);
  // Pictures without times must be the same on every machine.
  if (!view_.with_times) view_.device = "this machine";
}

void PanelPicture::build(GuiPass& gui) {
  gui.begin(frame_.width(), frame_.height());
  draw_workspace(workspace_, view_);
  gui.build();
}

void PanelPicture::rasterise(GuiPass& gui, const Renderer& renderer) {
  const ScreenRect rect = scene_rect(frame_.width(), frame_.height());
  frame_.place(renderer, static_cast<int>(rect.x), static_cast<int>(rect.y));
  gui.rasterise(frame_.target());
}

Image PanelPicture::draw(GuiPass& gui, World& world, const StepStats& stats, const Renderer& renderer,
                         const ValueRange& range) {
  fill(world, stats, history_, world.tree().level_sizes(), range);
  // ImGui needs several frames to lay out auto-sized items.
  for (int round = 0; round < 3; ++round) {
    build(gui);
    rasterise(gui, renderer);
  }
  return frame_.read();
}

}  // namespace collidoscope

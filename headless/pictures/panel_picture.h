#pragma once
// Pictures of the viewer's panels, without a viewer: the same workspace, drawn by the same function, around
// the same 3D view. Owns the workspace and the window's framebuffer; needs ImGui's context and the GL context
// that were current when it was made.

#include <optional>
#include <string>

#include "ui/workspace.h"
#include "viewer/render/frame_layers.h"
#include "viewer/render/frame_uniforms.h"
#include "viewer/render/gui_pass.h"
#include "viewer/render/image.h"
#include "viewer/render/renderer.h"
#include "viewer/render/window_frame.h"
#include "viewer/session/effect_costs.h"
#include "viewer/session/live_world.h"
#include "viewer/session/tree_inspector.h"

namespace collidoscope {

class PanelPicture {
 public:
  /// `timings`: times as measured, else dashes, so that pictures repeat.
  PanelPicture(const World& world, const FrameLayers& layers, int width, int height, bool timings);

  /// What the panels leave for the 3D view on a picture of this size.
  static ScreenRect scene_rect(int width, int height);

  Workspace& workspace() { return workspace_; }
  EffectCosts& costs() { return costs_; }
  /// Before the 3D view is drawn: measures the tree where its panel is unfolded, meets what is requested of
  /// it, and marks the selection.
  void refresh(World& world, Renderer& renderer, const ReferenceView& reference = {});
  /// What draws, as the status line says it.
  void set_renderer(const std::string& renderer, bool software, const std::string& display_path);
  /// After each step: graphs show it.
  void record(World& world);
  /// The 3D view must have been drawn by `renderer`, in the size of scene_rect().
  Image draw(GuiPass& gui, World& world, const StepStats& stats, const Renderer& renderer,
             const ValueRange& range);

  /// A frame of it in parts, for those who time them. What the panels show of a state; `history` must stay.
  void fill(World& world, const StepStats& stats, const History& history,
            const std::vector<std::int64_t>& level_sizes, const ValueRange& range);
  /// The CPU lists what is to be drawn,
  void build(GuiPass& gui);
  /// and OpenGL draws it, around the picture of `renderer`.
  void rasterise(GuiPass& gui, const Renderer& renderer);

 private:
  Workspace workspace_;
  WorkspaceView view_;
  History history_;
  TreeInspector tree_;
  EffectCosts costs_;
  std::optional<BodyReport> selected_;
  WindowFrame frame_;
};

}  // namespace collidoscope

#pragma once
// Pictures of the viewer's panels without a viewer. The same function draws the same workspace around the 3D
// view. Owns the workspace and the window's framebuffer. Needs the ImGui and GL contexts that were current at
// construction.

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
  /// `timings`: show measured times; otherwise show dashes, so that pictures are reproducible. Sizes in
  /// pixels.
  PanelPicture(const World& world, const FrameLayers& layers, int width, int height, bool timings);

  /// The rectangle for the 3D view in a picture of this size.
  static ScreenRect scene_rect(int width, int height);

  Workspace& workspace() { return workspace_; }
  EffectCosts& costs() { return costs_; }
  /// Call before drawing the 3D view. Measures the tree if its panel is open, executes the panel's requests,
  /// and marks the selection.
  void refresh(World& world, Renderer& renderer, const ReferenceView& reference = {});
  /// Sets the renderer description in the status line.
  void set_renderer(const std::string& renderer, bool software, const std::string& display_path);
  /// Call after each step. Adds the step to the graphs.
  void record(World& world);
  /// Draws the picture. Precondition: `renderer` has drawn the 3D view in the size of scene_rect().
  Image draw(GuiPass& gui, World& world, const StepStats& stats, const Renderer& renderer,
             const ValueRange& range);

  /// Parts of a frame, for separate timing.
  /// Sets the panels' contents to a state. `history` must stay valid.
  void fill(World& world, const StepStats& stats, const History& history,
            const std::vector<std::int64_t>& level_sizes, const ValueRange& range);
  /// Builds ImGui's draw list on the CPU.
  void build(GuiPass& gui);
  /// Draws the list with OpenGL around the picture of `renderer`.
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

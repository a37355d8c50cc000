#pragma once
// The workspace: plain data for all that panels show and change, and one function that draws them. The caller
// (the viewer, or a capture) owns a Workspace, reads the requests that panels left in it, and fills a
// WorkspaceView from what it runs. No GL, no CUDA, no window.

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim_cuda/measure/body_report.h"
#include "sim_cuda/publish/frame_layers.h"
#include "sim_cuda/publish/publish.h"
#include "sim_cuda/run/history.h"
#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/run_options.h"
#include "sim_cuda/scene/scene.h"
#include "sim_cuda/scene/settings_patch.h"
#include "sim_cuda/solver/residual.h"
#include "ui/accuracy_view.h"
#include "ui/break_view.h"
#include "ui/effect_view.h"
#include "ui/hard_cases_view.h"
#include "ui/legend_text.h"
#include "ui/reference_view.h"
#include "ui/tree_panel_view.h"

namespace collidoscope {

/// The settings of a run that panels show and change.
struct Settings : RunSettings {
  std::optional<OnFailure> guards;  ///< unset: they are off; their limits are the scene's, if it has some

  friend bool operator==(const Settings& a, const Settings& b) {
    return equal_settings(a, b) && a.guards == b.guards;
  }
};

/// What the 3D view shows.
enum class CameraRequest { none, frame_all, frame_selection, front, side, top, orthographic };
enum class Theme { dark, light };

struct SpeedChoice {
  double speed;      ///< simulated seconds in each second; 0: a step in every drawn frame
  const char* name;  ///< in names of widgets
  const char* label;
};
inline constexpr std::array<SpeedChoice, 6> speed_choices{{{0.1, "0.1 ×", "0.1 × real time"},
                                                           {0.25, "0.25 ×", "0.25 × real time"},
                                                           {0.5, "0.5 ×", "0.5 × real time"},
                                                           {1, "1 × real time", "1 × real time"},
                                                           {2, "2 ×", "2 × real time"},
                                                           {0, "a step a frame", "one step per frame"}}};

/// Which panels are unfolded.
struct PanelVisibility {
  bool left = true, right = true, bottom = true;  ///< whole columns, and the strip of graphs
  bool run = true, settings = true, layers = true, camera = true, timing = true, numbers = true,
       inspector = true, tree = false, convergence = false,  ///< measuring takes time
      effects = false,                                       ///< rarely asked for
      breaks = false, hard_cases = false,                    ///< runs them where somebody said so
      accuracy = false;                                      ///< measures as long as it is unfolded

  friend bool operator==(const PanelVisibility&, const PanelVisibility&) = default;
};

/// A part of the screen, in pixels from its top left corner.
struct ScreenRect {
  float x = 0, y = 0, width = 0, height = 0;
};

struct Workspace {
  Settings settings;              ///< as requested; the owner takes them over, or puts back what is in effect
  bool adjusting = false;         ///< a slider of `settings` is held
  bool adjusting_result = false;  ///< one that changes the result: the run waits, so that it is one change
  /// What was typed last, where it was refused.
  struct InputFault {
    std::string widget, text;
  };
  std::optional<InputFault> input_fault;
  std::string typed_text;  ///< in the field that has the keyboard
  FrameLayers layers = window_layers();
  bool levels_chosen = false;  ///< else boxes start with the levels 2 to 4

  bool playing = true;
  double speed = 1;  ///< of speed_choices
  // Requests, cleared by the owner once they are met.
  int step_requests = 0;
  bool restart_requested = false, screenshot_requested = false, csv_requested = false, json_requested = false;
  bool changes_file_requested = false;  ///< a file of what was changed since the start
  bool projectile_requested = false;    ///< a new body, from the camera
  bool removal_requested = false;       ///< of the selected body
  bool measure_effects = false;         ///< what each costs, anew where something else is simulated
  bool reference_requested = false;     ///< a reference of the run, from the bodies as they are
  CameraRequest camera_request = CameraRequest::none;

  std::optional<std::uint32_t> selection;  ///< id of a body
  bool follow = false;                     ///< the camera goes with it
  bool show_path = true;                   ///< its boxes in the tree are drawn
  /// The rows of its contacts while the pointer rests on them: they keep their places.
  struct ContactRows {
    std::uint32_t body = 0;
    std::vector<std::uint32_t> others;  ///< ids, from the top
    bool hovered = false;
  } contact_rows;

  TreeRequests tree;
  AccuracyRequests accuracy;
  HardCasesRequests hard_cases;
  BreakRequests breaks;

  int window = 240;        ///< steps that graphs and tables speak of
  int hovered_stage = -1;  ///< under the pointer, in graph or table; of History::stages()
  int chosen_stage = -1;   ///< by a click in the table; highlighted where none is under the pointer
  int hovered_level = -1;  ///< under the pointer, in a bar of levels
  bool help = false, hint = true;
  Theme theme = Theme::dark;
  float font_scale = 1;
  float largest_font_scale = 3;  ///< that acts on this screen; set by the owner
  PanelVisibility visible_panels;

  /// One step, then pause. A key that is held asks for no step while one is pending.
  void request_step(bool held = false) {
    playing = false;
    if (!held || step_requests == 0) ++step_requests;
  }
  /// Steps that are pending are dropped.
  void play_or_pause() {
    playing = !playing;
    step_requests = 0;
  }
  /// By a factor, within what acts.
  void scale_font(float factor) {
    const float acts = std::min(font_scale, largest_font_scale);
    font_scale = std::clamp(acts * factor, 0.6f, std::max(largest_font_scale, 1.0f));
  }

  std::vector<std::string> errors;  ///< each until it is dismissed
  std::string notice;               ///< said once, of the last change

  /// Of the last draw: where the 3D view is, and each widget by its name, if it can be seen and used.
  ScreenRect scene_view;
  std::vector<std::pair<std::string, ScreenRect>> widgets;
  std::string
      pressed;  ///< the widget that the left button went down on last; what covers one takes its clicks
};

/// What a run looks like at the moment. Pointers are the caller's, for the time of the draw.
struct WorkspaceView {
  std::string scene;
  bool generated = false;  ///< N, radius, seed and variant can be changed
  Settings active_settings;
  double greatest_radius = limits::max_radius;  ///< m, that can be chosen: the spheres must fit in the box
  /// Beside the N of a generator: removed of it; listed in the scene or added.
  std::int64_t removed_bodies = 0, other_bodies = 0;
  bool edited = false;                    ///< a physical setting was changed since state 0
  std::int64_t changes = 0;               ///< that a replay would make
  std::string executor, device;           ///< "CPU" or "CUDA", and its name
  std::string renderer, display_path;     ///< what draws, and how the data get there
  bool software = false;                  ///< the renderer draws on the CPU
  double view_scale = 1;                  ///< of the 3D view: pixels drawn for each one seen, along an axis
  std::string cuda_unavailable_reason;    ///< why CUDA cannot be chosen; empty: it can
  std::vector<std::string> broad_phases;  ///< names, the default first
  std::vector<std::string> effects;       ///< that are on
  int substeps = 1;                       ///< of a step, also where they are "auto"
  std::vector<EffectView> effect_views;   ///< of all; empty while their panel is folded
  bool measuring_effects = false;
  int key_bits = 0;  ///< of the broad phase's Morton keys; 0: it has none

  StepStats stats;
  double time = 0;              ///< s of simulated time
  double real_time_factor = 0;  ///< simulated seconds in a second
  double frames_per_second = 0;
  std::int64_t allocated_bytes = 0;
  std::int64_t tree_nodes = 0;            ///< boxes in it
  std::vector<std::int64_t> level_sizes;  ///< boxes of each level of the tree, from the root
  const History* history = nullptr;
  std::vector<Residual> residuals;  ///< of the last step; empty where they were not recorded

  std::vector<std::uint32_t> level_colors;    ///< 0xAABBGGRR, by level
  Legend body_colors, box_colors;             ///< what their colours mean
  std::int64_t boxes_drawn = 0;               ///< where they are not coloured by level
  std::vector<std::uint32_t> contact_colors;  ///< from weak to strong
  double max_impulse = 0;  ///< N s, of the last of them, the first has a thousandth; 0: none are known

  ReferenceView reference;  ///< that ghosts and errors are of
  double error_scale = 1;   ///< of the lines that show errors, in effect

  std::optional<StopView> stop;       ///< what the run has stopped at
  std::vector<std::uint32_t> frozen;  ///< ids, ascending, of bodies that guards have fixed

  const BodyReport* selected = nullptr;
  const TreePanelView* tree = nullptr;        ///< null: nobody asked
  const AccuracyView* accuracy = nullptr;     ///< so here
  const HardCasesView* hard_cases = nullptr;  ///< and here
  std::vector<std::uint32_t> mark_colors;     ///< by BoxMark
  /// Around the selected body, in pixels of the screen; empty where it cannot be seen.
  std::vector<std::pair<float, float>> outline;
  std::vector<std::vector<std::pair<float, float>>> frozen_outlines;  ///< so too, of the first of `frozen`
  bool orthographic = false;

  bool with_times = true;  ///< false: times are drawn as a dash, so that pictures repeat
};

/// Draws everything but the 3D view, for which it leaves Workspace::scene_view, between ImGui::NewFrame() and
/// Render().
void draw_workspace(Workspace& workspace, const WorkspaceView& view);

/// After draw_workspace() was left by an exception: ends what it began, and shows Workspace::errors.
void end_unfinished_panels(Workspace& workspace);

/// Where the 3D view will be on a screen of this size.
ScreenRect scene_view_rect(const Workspace& workspace, float width, float height, float font_size);

inline constexpr float min_font_scale = 0.6f, max_font_scale = 3;
/// The largest size of text, 1 or more, at which the unfolded columns leave the 3D view 40 % of the width.
float largest_font_scale(int width, int height, float content_scale, const PanelVisibility& visible_panels);
/// Pixels of the panels' font on a screen of this size: as `font_scale` asks for, or as large as fits.
float workspace_font_size(int width, int height, float font_scale, float content_scale = 1,
                          const PanelVisibility& visible_panels = {});

}  // namespace collidoscope

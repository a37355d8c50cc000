#pragma once
// The workspace: plain data that panels show and change, and the function that draws them. The caller (viewer
// or capture) owns a Workspace, handles the requests in it, and fills a WorkspaceView from its run. No GL, no
// CUDA, no window.

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
#include "sim_cuda/run/run_lanes.h"
#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/run_options.h"
#include "sim_cuda/scene/scene.h"
#include "sim_cuda/scene/settings_patch.h"
#include "sim_cuda/solver/residual.h"
#include "ui/accuracy_view.h"
#include "ui/break_view.h"
#include "ui/columns_dialog.h"
#include "ui/effect_view.h"
#include "ui/hard_cases_view.h"
#include "ui/launch_map_view.h"
#include "ui/legend_text.h"
#include "ui/plugin_dialog.h"
#include "ui/reference_view.h"
#include "ui/tree_panel_view.h"

namespace collidoscope {

/// Settings of a run that panels show and change.
struct Settings : RunSettings {
  std::optional<OnFailure> guards;  ///< unset: off; limits are those of the scene, if set

  friend bool operator==(const Settings& a, const Settings& b) {
    return equal_settings(a, b) && a.guards == b.guards;
  }
};

/// A state at which something was changed or found.
struct TimelineMark {
  enum class Kind { change, condition, violation } kind;
  std::int64_t state;
  std::string text;
};

/// Requested change of the camera.
enum class CameraRequest { none, frame_all, frame_selection, front, side, top, orthographic };
enum class Theme { dark, light };

struct SpeedChoice {
  double speed;      ///< simulated seconds per second; 0: one step per drawn frame
  const char* name;  ///< part of the widget names
  const char* label;
};
inline constexpr std::array<SpeedChoice, 6> speed_choices{{{0.1, "0.1 ×", "0.1 × real time"},
                                                           {0.25, "0.25 ×", "0.25 × real time"},
                                                           {0.5, "0.5 ×", "0.5 × real time"},
                                                           {1, "1 × real time", "1 × real time"},
                                                           {2, "2 ×", "2 × real time"},
                                                           {0, "1 step per frame", "one step per frame"}}};

/// Open panels.
struct PanelVisibility {
  bool left = true, right = true, bottom = true;  ///< whole columns and the bottom strip
  bool run = true, settings = true, layers = true, camera = true, timing = true, numbers = true,
       inspector = true, tree = false, convergence = false,  ///< measured only while open
      effects = false, breaks = false, hard_cases = false, accuracy = false,
       launch_map = false;  ///< measured only while open

  friend bool operator==(const PanelVisibility&, const PanelVisibility&) = default;
};

/// Part of the window in pixels from its top left corner.
struct ScreenRect {
  float x = 0, y = 0, width = 0, height = 0;
};

struct Workspace {
  Settings settings;       ///< requested; the caller applies them or restores the current ones
  bool adjusting = false;  ///< a slider of `settings` is held
  bool adjusting_result =
      false;  ///< a slider that affects the result is held; the run waits, so that the drag is one change
  /// The last rejected input.
  struct InputFault {
    std::string widget, text;
  };
  std::optional<InputFault> input_fault;
  std::string typed_text;  ///< text in the focused field
  FrameLayers layers = window_layers();
  bool levels_chosen = false;  ///< false: boxes start with levels 2 to 4

  bool playing = true;
  bool backwards = false;  ///< goes back from state to state; `playing` is false
  double speed = 1;        ///< one of speed_choices
  // Requests, cleared by the caller when handled.
  int step_requests = 0;
  bool restart_requested = false, screenshot_requested = false, csv_requested = false, json_requested = false;
  std::optional<std::int64_t> state_request;  ///< go to this state of the run
  bool other_run_requested = false;           ///< open the run before the last branch
  bool recording_requested = false;           ///< write all states of the run to a file
  bool changes_file_requested = false;        ///< write the changes since the start to a file
  bool projectile_requested = false;          ///< add a body, launched from the camera
  bool removal_requested = false;             ///< remove the selected body
  bool measure_effects = false;               ///< measure the cost of each effect
  bool reference_requested = false;           ///< restart the reference from the present state
  CameraRequest camera_request = CameraRequest::none;

  std::optional<std::uint32_t> selection;  ///< id of a body
  bool follow = false;                     ///< camera follows the selected body
  bool show_path = true;                   ///< draw the body's path in the tree
  /// Rows of the selected body's contacts. The order is kept while the pointer is over them.
  struct ContactRows {
    std::uint32_t body = 0;
    std::vector<std::uint32_t> others;  ///< ids, from the top
    bool hovered = false;
  } contact_rows;

  TreeRequests tree;
  AccuracyRequests accuracy;
  LaunchMapRequests launch_map;
  HardCasesRequests hard_cases;
  BreakRequests breaks;

  int window = 240;        ///< number of steps in graphs and tables
  int hovered_stage = -1;  ///< under the pointer; index into History::stages(), -1: none
  int chosen_stage = -1;   ///< clicked in the table; highlighted while hovered_stage is -1
  int hovered_level = -1;  ///< under the pointer in a level bar; -1: none
  bool help = false, hint = true;
  Theme theme = Theme::dark;
  float font_scale = 1;
  float largest_font_scale = 3;  ///< limit for this window, set by the caller
  PanelVisibility visible_panels;

  /// Requests one step and pauses. A repeated key press adds no step while one is pending.
  void request_step(bool held = false) {
    playing = backwards = false;
    if (!held || step_requests == 0) ++step_requests;
  }
  /// Drops pending steps.
  void play_or_pause() {
    playing = !playing && !backwards;
    backwards = false;
    step_requests = 0;
  }
  void play_or_pause_backwards() {
    backwards = !backwards;
    playing = false;
    step_requests = 0;
  }
  /// Requests a state of the run and pauses.
  void request_state(std::int64_t state) {
    state_request = state;
    playing = backwards = false;
    step_requests = 0;
  }
  /// Multiplies the font scale, within its limits.
  void scale_font(float factor) {
    const float acts = std::min(font_scale, largest_font_scale);
    font_scale = std::clamp(acts * factor, 0.6f, std::max(largest_font_scale, 1.0f));
  }

  ColumnsDialog columns;            ///< of a file of bodies that is being opened
  PluginDialog plugin;              ///< of a library that was dropped on the window
  bool columns_requested = false;   ///< request: choose the columns of the file again
  std::vector<std::string> errors;  ///< shown until dismissed
  std::string notice;               ///< message about the last action, shown for some seconds
  std::string last_notice;          ///< the newest notice, also after it has disappeared

  /// Results of the last draw: area of the 3D view, and the visible enabled widgets by name.
  ScreenRect scene_view;
  bool has_timeline = false;  ///< there is a strip over the graphs; set by the caller
  std::vector<std::pair<std::string, ScreenRect>> widgets;
  std::string pressed;  ///< topmost widget under the last press of the left button
};

/// State of the run for one draw. Pointers must stay valid during the draw.
struct WorkspaceView {
  std::string scene;
  bool has_body_file = false;  ///< the bodies are those of a file, and its columns can be chosen
  bool generated = false;      ///< the scene has exactly one generator, whose settings can be changed
  Settings active_settings;
  double greatest_radius =
      limits::max_radius;  ///< m, largest allowed max radius: the spheres must fit in the box
  /// Bodies removed from the generator; bodies listed in the scene or added.
  std::int64_t removed_bodies = 0, other_bodies = 0;
  bool edited = false;                    ///< a physical setting was changed since state 0
  std::int64_t changes = 0;               ///< number of recorded changes
  std::string executor, device;           ///< "CPU" or "CUDA"; device name
  std::string renderer, display_path;     ///< OpenGL renderer; transfer from simulator to OpenGL
  bool software = false;                  ///< the renderer runs on the CPU
  double view_scale = 1;                  ///< drawn pixels per shown pixel of the 3D view, along an axis
  std::string cuda_unavailable_reason;    ///< why CUDA is disabled; empty: enabled
  std::vector<std::string> broad_phases;  ///< names; the default comes first
  /// Of a broad phase that is a plug-in: whether its pairs are right. Empty: a built-in method.
  std::string pairs_note;
  std::string given_tree;  ///< file of a tree over the boxes of the scene, which is shown; empty: none
  bool has_wrong_pairs = false;
  std::vector<std::string> effects;      ///< names of the enabled effects
  int substeps = 1;                      ///< substeps per step, also if "auto"
  double substeps_missed = 0;            ///< see joint_substeps.h
  std::vector<EffectView> effect_views;  ///< all effects; empty while the panel is folded
  bool measuring_effects = false;
  bool measuring = false;              ///< a panel measures, or its last slice is in progress
  std::string tuned, tuned_rejection;  ///< see WorldInfo
  int key_bits = 0;                    ///< length of the Morton codes; 0: none

  StepStats stats;
  double time = 0;  ///< s, simulated time
  /// States of the run that can be reached. Unset: the run has no timeline.
  struct TimelineView {
    std::int64_t first = 0, last = 0;
    std::vector<TimelineMark> marks;
    RunLanes lanes;
    /// The run before the last branch: its last common state with this run, and its last state.
    struct Other {
      std::int64_t fork, last;
    };
    std::optional<Other> other;
  };
  std::optional<TimelineView> timeline;
  double real_time_factor = 0;  ///< simulated seconds per second
  double frames_per_second = 0;
  std::int64_t allocated_bytes = 0;
  std::int64_t tree_nodes = 0;            ///< number of boxes in the tree
  std::vector<std::int64_t> level_sizes;  ///< boxes per level of the tree, from the root
  const History* history = nullptr;
  std::vector<Residual> residuals;  ///< residuals of the last step; empty if not recorded

  std::vector<std::uint32_t> level_colors;    ///< 0xAABBGGRR, by level
  Legend body_colors, box_colors;             ///< legends of the body and box colours
  std::int64_t boxes_drawn = 0;               ///< number of drawn boxes, unless coloured by level
  std::vector<std::uint32_t> contact_colors;  ///< ascending impulse
  double max_impulse = 0;  ///< N s, of the last contact colour; the first is 1/1000 of it; 0: not recorded

  ReferenceView reference;  ///< reference of the layers ghosts and error vectors
  double error_scale = 1;   ///< length of a drawn error vector over the error

  std::optional<StopView> stop;       ///< present stop of the run
  std::vector<std::uint32_t> frozen;  ///< ids of frozen bodies, ascending

  const BodyReport* selected = nullptr;
  const TreePanelView* tree = nullptr;        ///< null: not requested
  const AccuracyView* accuracy = nullptr;     ///< null: not requested
  const LaunchMapView* launch_map = nullptr;  ///< null: not requested
  const HardCasesView* hard_cases = nullptr;  ///< null: not requested
  std::vector<std::uint32_t> mark_colors;     ///< indexed by BoxMark
  /// Two bodies whose pair is wrong, by their outlines in pixels of the window.
  struct FaultyPairView {
    std::vector<std::pair<float, float>> a, b;
    std::string text;  ///< such as "missing 4-17"
  };
  std::vector<FaultyPairView> faulty_pairs;
  /// Outline of the selected body in pixels of the window; empty if it is not visible.
  std::vector<std::pair<float, float>> outline;
  std::vector<std::vector<std::pair<float, float>>>
      frozen_outlines;  ///< outlines of the first bodies in `frozen`
  bool orthographic = false;

  bool with_times = true;  ///< false: times are drawn as a dash, for reproducible pictures
};

/// Draws all panels and sets Workspace::scene_view, the area of the 3D view. Call between ImGui::NewFrame()
/// and Render().
void draw_workspace(Workspace& workspace, const WorkspaceView& view);

/// Cleans up after draw_workspace() threw: closes open windows and shows Workspace::errors.
void end_unfinished_panels(Workspace& workspace);

/// Area of the 3D view in a window of this size.
ScreenRect scene_view_rect(const Workspace& workspace, float width, float height, float font_size);

inline constexpr float min_font_scale = 0.6f, max_font_scale = 3;
/// Largest font scale, at least 1, at which the open columns leave the 3D view 40 % of the width.
float largest_font_scale(int width, int height, float content_scale, const PanelVisibility& visible_panels);
/// Font size of the panels in pixels: `font_scale`, limited to the largest that fits.
float workspace_font_size(int width, int height, float font_scale, float content_scale = 1,
                          const PanelVisibility& visible_panels = {});

}  // namespace collidoscope

#pragma once
// The desktop program: one window on one LiveWorld. Owns all parts; lives as long as main() runs.

#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "headless/cli/command_line.h"
#include "sim_cuda/snapshot/presimulation.h"
#include "ui/workspace.h"
#include "viewer/gui_input.h"
#include "viewer/render/gui_pass.h"
#include "viewer/render/window_frame.h"
#include "viewer/session/automation.h"
#include "viewer/session/effect_costs.h"
#include "viewer/session/live_accuracy.h"
#include "viewer/session/live_breakpoints.h"
#include "viewer/session/live_launch_map.h"
#include "viewer/session/live_reference.h"
#include "viewer/session/live_stability.h"
#include "viewer/session/live_world.h"
#include "viewer/session/tree_inspector.h"
#include "viewer/view/scene_view.h"
#include "viewer/view/simulation_thread.h"
#include "viewer/window.h"

namespace collidoscope {

class App {
 public:
  /// Throws InputError, MachineError and Cancelled. Closing the window during long work requests
  /// `options.run.cancellation`, if set.
  App(const Start& start, const Options& options);
  /// Runs until the window is closed or `ended` returns true, then saves the workspace. Returns whether work
  /// was cancelled: the App must not be used afterwards.
  bool run(const std::function<bool()>& ended);

 private:
  using Clock = std::chrono::steady_clock;

  World make_world(const Start& start);
  void wait_for_events();
  void end_steps();
  void frame(double seconds);

  // The simulation thread (app_simulation.cpp).
  bool needs_world() const;
  void use_world();
  void handle_result();
  void follow_settings(const Settings& now);
  void publish();
  void continue_run();
  SimulationThread::Plan plan() const;
  /// Work on the world that can take longer than a frame. The simulation thread does it, and then this thread
  /// calls `then`, unless there was an error.
  struct Work {
    std::string what;  ///< shown while it lasts
    std::function<void()> run, then;
  };
  void begin(Work work) { works_.push_back(std::move(work)); }
  void change_world(Change change, const std::string& what);
  void end_work(const SimulationThread::Result& result);
  void show_progress();
  void cancel_work();
  void stop_measurements();
  bool is_slow_to_change() const;

  /// Runs an action. An error is shown in the window, and pauses the run if `step` is set. Returns true if
  /// there was no error.
  template <class Action>
  bool with_error_bar(Action action, bool step = false);
  void report_error(const std::string& line, bool step);

  // Mouse and keyboard (app_input.cpp).
  void handle(const InputEvent& event);
  void handle_key(const InputEvent& event);
  void handle_button(const InputEvent& event);
  void handle_move(const InputEvent& event);
  void go_to_mark(bool after);
  void fly_camera(double seconds);

  // Requests from panels (app_requests.cpp).
  void handle_requests();
  void apply_settings();
  bool finish_presimulation(const Scene& scene, std::optional<RunState>& rest);
  void restart();
  void go_to_requested_state();
  void play_backwards();
  void show_notice(const std::string& notice);
  void export_history(bool csv);
  void export_changes();
  void save_recording();
  void spawn_projectile();
  void remove_selected();
  void follow_selection();
  void measure_effects();
  void follow_reference();
  bool shows_accuracy() const {
    return workspace_.visible_panels.right && workspace_.visible_panels.accuracy;
  }
  void measure_accuracy();
  bool shows_launch_map() const {
    return workspace_.visible_panels.right && workspace_.visible_panels.launch_map;
  }
  void measure_launch_map();
  void save_picture();

  // Stops by guards and break conditions (app_breaks.cpp).
  void handle_stop_request();
  bool is_blocked_by_stop();

  // Files that are dropped on the window (app_files.cpp).
  void open_dropped_files();
  void open_files(CommandLine line);
  void follow_columns();
  void follow_plugin();
  void show_import(const Start& start);

  // Hard cases (app_hard_cases.cpp).
  bool shows_hard_cases() const {
    return workspace_.visible_panels.right && workspace_.visible_panels.hard_cases;
  }
  void follow_hard_cases();
  void show_case(LiveStability::Opened opened);
  void restore_scene_before();
  void show_another_scene();

  void draw_scene(const ScreenRect& rect);
  void fill(WorkspaceView& view);
  void follow_panels();
  void write_automation(const WorkspaceView& view, double ui_ms);

  Options options_;
  std::optional<Automation> automation_;  ///< opened first: an invalid file is reported before a window opens
  std::string automation_failure_;        ///< error on writing the automation file; ends the program
  Window window_;
  GuiPass gui_;
  GuiInput input_;
  WindowFrame picture_;
  LiveWorld live_;
  SceneView scene_;
  TreeInspector tree_;
  LiveReference reference_;
  LiveAccuracy accuracy_;
  LiveLaunchMap launch_map_;
  LiveBreakpoints breaks_;
  LiveStability stability_;
  std::unique_ptr<PublishedState> next_;  ///< the state that is being drawn
  WorkspaceView run_;                     ///< view of the state in the picture
  History history_;                       ///< up to this state
  Settings known_settings_;               ///< settings of the run when they were last compared
  bool has_world_ = false;  ///< the simulation thread is paused, and this thread may use live_ and breaks_
  bool publish_skipped_ = false;  ///< in this frame, as an earlier state was being drawn
  struct ReplacedRun {
    Start start;
    RunOptions options;
    LiveWorld::Record record;
  };
  std::optional<ReplacedRun> run_before_cases_;  ///< run that was replaced by a hard case
  std::optional<Presimulation> presimulation_;   ///< pre-simulation of the next run
  std::string settling_scene_;                   ///< scene file text of the pre-simulated scene
  std::deque<Work> works_;                       ///< the first one may be in progress
  /// Time slices of other work, in this frame. They return whether there is more to do.
  std::vector<std::function<bool()>> slices_;
  bool work_in_progress_ = false, slices_in_progress_ = false, step_in_progress_ = false,
       presimulating_ = false, cancel_requested_ = false;
  bool measuring_ = false;  ///< a panel measures in slices
  Clock::time_point work_since_;
  Clock::time_point went_back_;  ///< time of the last step backwards
  std::string change_notice_;    ///< of the last change of settings
  EffectCosts costs_;
  int costs_generation_ = -1;   ///< generation of the World that costs_ was measured on
  bool keeps_settings_ = true;  ///< write the settings file at exit; set with workspace_
  Workspace workspace_;
  std::string renderer_name_, picture_file_;
  std::string cuda_unavailable_reason_;  ///< why CUDA is disabled; empty: enabled
  bool software_ = false, cancelled_ = false;

  std::int64_t frame_ = 0;
  bool has_news_ = true;              ///< the last frame showed a new state, or a part of one
  bool extends_last_change_ = false;  ///< the last change came from a slider that is still held
  Clock::time_point notice_since_;
  struct Moment {
    Clock::time_point when;
    double simulated;  ///< s, total simulated time of all runs
  };
  std::deque<Moment> moments_;  ///< frames of the last second
  double frame_seconds_ = 0;    ///< of the last frame
  /// Contents of panels whose data the simulation thread changes.
  std::vector<EffectView> effects_;
  bool measuring_effects_ = false;
  AccuracyView accuracy_view_;
  LaunchMapView launch_map_view_;
  HardCasesView hard_cases_view_;
  ReferenceView reference_view_;

  std::set<int> buttons_, keys_;  ///< pressed over the 3D view and still held
  double mouse_x_ = 0, mouse_y_ = 0, moved_ = 0;
  SimulationThread simulation_;  ///< last: uses other members until it is destroyed
};

}  // namespace collidoscope

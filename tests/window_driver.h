#pragma once
// Drives the viewer's window for tests: an own X server (Xvfb), the viewer, and xdotool for real mouse and
// key events. Widgets are found by name in the output of --automation. All started processes are ended.

#include <nlohmann/json.hpp>

#include <sys/types.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/test_files.h"
#include "viewer/render/image.h"

namespace collidoscope {

/// Empty, or the missing requirement of window tests.
std::string window_tests_unavailable_reason();

class WindowDriver {
 public:
  using Json = nlohmann::json;

  using Environment = std::vector<std::pair<std::string, std::string>>;
  enum class Wait { for_frame, for_window };

  /// `environment`: additional variables for the programs. Returns after the first frame, or when the window
  /// exists. Throws std::runtime_error if it does not appear.
  explicit WindowDriver(const std::vector<std::string>& arguments, Environment environment = {},
                        Wait wait = Wait::for_frame);
  ~WindowDriver();
  WindowDriver(const WindowDriver&) = delete;
  WindowDriver& operator=(const WindowDriver&) = delete;

  /// The newest frame whose panels and picture show one state.
  const Json& frame();
  /// Waits for a frame that begins after this call.
  const Json& next_frame();
  /// Waits at most `seconds` for a frame with so(frame). Returns whether there was one.
  bool wait_for(const std::function<bool(const Json&)>& so, double seconds = 30);
  bool running();
  /// Closes the window as Ctrl+C does; returns the exit status.
  int end();
  /// Drops a file on the middle of the window, as a file manager does.
  void drop_file(const std::string& path);
  /// Presses the close button; returns at once.
  void press_close_button();
  /// Returns the seconds until the program ends, with its exit status in `status`; -1 after `most` seconds.
  double seconds_to_end(int& status, double most = 20);
  void send_signal(int number);
  /// The number of colours in the window, as shown by the X server.
  std::size_t colors_shown();

  /// The centre of a widget. Fails the wait and throws if no widget of that name is visible.
  std::pair<int, int> place(const std::string& widget);
  bool sees(const std::string& widget);

  void hands(const std::vector<std::string>& xdotool);  ///< any xdotool command
  /// Waits until the window has handled this command, which releases that many keys and buttons.
  void input(const std::vector<std::string>& xdotool, std::int64_t releases);
  void move(int x, int y);
  void click(const std::string& widget);
  void click_at(int x, int y, int button = 1);
  void key(const std::string& name);
  void type_into(const std::string& widget, const std::string& text);
  void type(const std::string& text);  ///< replaces the field's content, then Return
  void drag(int from_x, int from_y, int to_x, int to_y, int button = 1);
  void resize(int width, int height);
  /// Moves the window to this place of the 1920x1200 screen; initially it is at (0, 0).
  void move_window(int x, int y);
  /// The window's picture on the X server.
  Image shown();

  std::string errors();  ///< the program's stderr
  std::string file(const std::string& name) const { return (folder_ / name).string(); }

 private:
  pid_t start(const std::vector<std::string>& command, const std::string& out, const std::string& err);
  unsigned long window();
  void read_lines();

  TemporaryFolder folder_;
  Environment environment_;
  std::string display_;
  pid_t server_ = -1, program_ = -1;
  std::size_t read_to_ = 0;
  std::string partial_;
  Json frame_;
  std::int64_t newest_ = 0, releases_ = 0;  ///< number and releases of the newest frame, complete or not
  int status_ = -1;
  int x_ = 0, y_ = 0;  ///< position of the window
};

}  // namespace collidoscope

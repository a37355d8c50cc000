#pragma once
// A person at the window, for tests: an X server of its own (Xvfb), the viewer in it, and xdotool's hands,
// which make real mouse and key events. Finds widgets by name in what --automation writes. Ends all that it
// started.

#include <nlohmann/json.hpp>

#include <sys/types.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/test_files.h"
#include "viewer/render/image.h"

namespace collidoscope {

/// Empty, or what is missing here for a test that needs a window.
std::string window_tests_unavailable_reason();

class WindowDriver {
 public:
  using Json = nlohmann::json;

  using Environment = std::vector<std::pair<std::string, std::string>>;
  enum class Wait { for_frame, for_window };

  /// `environment`: variables of the programs, beside those of this process. Returns when the first frame is
  /// drawn, or when the window is there. Throws std::runtime_error where it does not come up.
  explicit WindowDriver(const std::vector<std::string>& arguments, Environment environment = {},
                        Wait wait = Wait::for_frame);
  ~WindowDriver();
  WindowDriver(const WindowDriver&) = delete;
  WindowDriver& operator=(const WindowDriver&) = delete;

  /// The newest frame.
  const Json& frame();
  /// Waits for a frame that was begun after this call.
  const Json& next_frame();
  /// Waits, at most `seconds`, until a frame is so. Returns whether one was.
  bool wait_for(const std::function<bool(const Json&)>& so, double seconds = 30);
  bool running();
  /// Closes the window as Ctrl+C does; its exit status.
  int end();
  /// The same by its close button; returns at once.
  void press_close_button();
  /// Seconds until the program has ended; its status is in `status`. -1 where it has not after `most`.
  double seconds_to_end(int& status, double most = 20);
  void send_signal(int number);
  /// How many colours the X server shows of the window.
  std::size_t colors_shown();

  /// The middle of a widget; fails the wait, and throws, if none of that name is seen.
  std::pair<int, int> place(const std::string& widget);
  bool sees(const std::string& widget);

  void hands(const std::vector<std::string>& xdotool);  ///< any xdotool command
  void move(int x, int y);
  void click(const std::string& widget);
  void click_at(int x, int y, int button = 1);
  void key(const std::string& name);
  void type_into(const std::string& widget, const std::string& text);
  void type(const std::string& text);  ///< in place of what the field holds, and Return
  void drag(int from_x, int from_y, int to_x, int to_y, int button = 1);
  void resize(int width, int height);
  /// To this place on the screen, of 1920x1200 pixels; at first it is at (0, 0).
  void move_window(int x, int y);
  /// What the X server shows of the window.
  Image shown();

  std::string errors();  ///< what the program wrote on stderr
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
  int status_ = -1;
  int x_ = 0, y_ = 0;  ///< of the window
};

}  // namespace collidoscope

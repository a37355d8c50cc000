#pragma once
// Random input for the window, from a seed. The walker prefers the least touched visible widget and opens the
// list that holds it. Uniform random clicks would need hours to reach the last of 250 widgets. Ties,
// positions, keys and wheel events are random, and so is one touch in four, since unusual orders find faults.
// Frame times vary, so the same seed gives another walk; trail() records it.

#include <map>
#include <random>
#include <set>
#include <string>

#include "tests/window_driver.h"

namespace collidoscope {

class WindowWalker {
 public:
  /// Statistics of a widget.
  struct Widget {
    int offers = 0;   ///< touches while it was visible
    int touches = 0;  ///< touches on it: clicked, dragged or typed into
    int presses = 0;  ///< touches that the program attributed to it; a widget on top may receive the touch
    double x = 0;     ///< pixels, last seen position
  };

  WindowWalker(WindowDriver& window, unsigned seed) : window_(window), random_(seed) {}

  void step();

  /// All widgets seen so far, by name.
  const std::map<std::string, Widget>& widgets() const { return widgets_; }
  int touches() const { return touches_; }
  const std::string& trail() const { return trail_; }

 private:
  using Json = WindowDriver::Json;

  std::size_t pick(std::size_t n) { return static_cast<std::size_t>(random_() % n); }
  int within(const Json& rect, std::size_t axis, double from = 0, double to = 1);
  void note(const std::string& what) { trail_ += what + ' '; }
  /// The number of touches, weighted; for a list, the minimum over its choices.
  int wear(const std::string& name) const;
  void remember_choices(const Json& now);
  /// The least touched widget of the open list, or else of all, if it is not visible; otherwise empty.
  std::string out_of_sight(const Json& widgets);
  void seek(const std::string& name, const Json& now);

  void key();
  void wheel(const std::string& over, const Json& rect);
  void resize();
  void choose_body(const Json& widgets);
  void touch(const Json& widgets);
  void act_on(const std::string& name, const Json& rect);

  WindowDriver& window_;
  std::mt19937 random_;
  std::map<std::string, Widget> widgets_;
  std::map<std::string, std::set<std::string>> choices_;  ///< choices of each list opened so far
  std::string open_list_;                                 ///< empty: none
  int touches_ = 0;
  std::string trail_;
};

}  // namespace collidoscope

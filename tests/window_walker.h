#pragma once
// Hands at the window that do anything, anywhere. Drawn from a seed, they mostly turn to what was touched
// least of all that can be seen, and open the list that holds it: pure chance would take hours to come round
// to the last of 250 widgets. Chance still decides between equals, where in a widget it is touched and how,
// what key or wheel comes between, and one touch in four altogether: order is what finds faults. Frames come
// when they come, so the same seed walks another way each time; trail() says where it went.

#include <map>
#include <random>
#include <set>
#include <string>

#include "tests/window_driver.h"

namespace collidoscope {

class WindowWalker {
 public:
  /// What a widget has been through.
  struct Widget {
    int offers = 0;   ///< touches while it could be seen
    int touches = 0;  ///< of them on it: clicked, dragged or typed into
    int presses = 0;  ///< of them that the program took: not when what lies over it took them
    double x = 0;     ///< pixels, where it was seen last
  };

  WindowWalker(WindowDriver& window, unsigned seed) : window_(window), random_(seed) {}

  void step();

  /// All that was ever seen, by name.
  const std::map<std::string, Widget>& widgets() const { return widgets_; }
  int touches() const { return touches_; }
  const std::string& trail() const { return trail_; }

 private:
  using Json = WindowDriver::Json;

  std::size_t pick(std::size_t n) { return static_cast<std::size_t>(random_() % n); }
  int within(const Json& rect, std::size_t axis, double from = 0, double to = 1);
  void note(const std::string& what) { trail_ += what + ' '; }
  /// How much it was touched, or the least touched choice in it.
  int wear(const std::string& name) const;
  void remember_choices(const Json& now);
  /// What was touched least, of the list that is open or else of all, where it cannot be seen; else empty.
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
  std::map<std::string, std::set<std::string>> choices_;  ///< of each list that was ever open
  std::string open_list_;                                 ///< empty: none
  int touches_ = 0;
  std::string trail_;
};

}  // namespace collidoscope

#pragma once
// Question before the window loads a plug-in that was dropped on it. Plain data between the window and the
// panel.

#include <string>

namespace collidoscope {

struct PluginDialog {
  bool open = false;
  std::string file;        ///< full path
  bool confirmed = false;  ///< request: test and load the library
};

}  // namespace collidoscope

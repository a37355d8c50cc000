#pragma once
// What the viewer remembers from one time to the next: layers, panels, theme, size of text, speed. The run's
// own settings are the scene's and the command line's, and are not kept. Free functions.

#include <string>

#include "ui/workspace.h"

namespace collidoscope {

/// $XDG_CONFIG_HOME/collidoscope/settings.json, else in ~/.config; empty where neither is set.
std::string settings_path();

/// As a file.
std::string settings_text(const Workspace& workspace);
/// Takes over what the text says; what it does not say, or says wrongly, stays. Returns one line if it is no
/// settings file at all, else nothing.
std::string read_settings(const std::string& text, Workspace& workspace);

struct RememberedSettings {
  std::string fault;           ///< one line for stderr, or empty
  bool may_be_written = true;  ///< at the end: false for what is no file of this version
};
/// The same from a file; one that is not there says nothing. A pipe or a folder is not opened.
RememberedSettings read_settings_file(const std::string& file, Workspace& workspace);

}  // namespace collidoscope

#pragma once
// Preferences of the viewer in a file: layers, panels, theme, text size, speed. Settings of a run come from
// the scene and the command line, and are not stored. Free functions.

#include <string>

#include "ui/workspace.h"

namespace collidoscope {

/// $XDG_CONFIG_HOME/collidoscope/settings.json, else in ~/.config; empty if neither variable is set.
std::string settings_path();

/// The text of the file.
std::string settings_text(const Workspace& workspace);
/// Applies the preferences in `text`. Missing or invalid entries are ignored. Returns one line if it is not a
/// settings file, else "".
std::string read_settings(const std::string& text, Workspace& workspace);

struct RememberedSettings {
  std::string fault;           ///< one line for stderr, or empty
  bool may_be_written = true;  ///< whether the file may be written at exit; false for another version
};
/// Reads a file. A missing file is no fault. Pipes and folders are not opened.
RememberedSettings read_settings_file(const std::string& file, Workspace& workspace);

}  // namespace collidoscope
